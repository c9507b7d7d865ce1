#include <stroma/mpm/surface_places.h>
#include <stroma/shapes/box.h>

#include <cmath>

namespace Stroma::Mpm
{
  namespace
  {
    /// Equal rectangles of the sides of a box: where the grid's lines go along it, they share them out alike.
    template <int dim>
    std::vector<SurfacePlace<dim>>
    places_of_box(const Shapes::Box<dim> &box, const double spacing)
    {
      std::vector<SurfacePlace<dim>> places;
      for (unsigned int side = 0; side < 2 * dim; ++side)
        {
          const unsigned int            axis = side / 2;
          std::array<unsigned int, dim> n;
          unsigned int                  all  = 1;
          double                        area = 1.;
          for (unsigned int d = 0; d < dim; ++d)
            {
              const double edge = box.upper[d] - box.lower[d];
              n[d]              = d == axis ? 1 : std::ceil(edge / spacing);
              all *= n[d];
              area *= d == axis ? 1. : edge / n[d];
            }
          for (unsigned int i = 0; i < all; ++i)
            {
              SurfacePlace<dim> place{box.lower, {}, area};
              for (unsigned int d = 0, rest = i; d < dim; rest /= n[d++])
                place.X[d] += d == axis ? (side % 2) * (box.upper[d] - box.lower[d]) :
                                          (rest % n[d] + .5) * (box.upper[d] - box.lower[d]) / n[d];
              place.normal[axis] = side % 2 ? 1. : -1.;
              places.push_back(place);
            }
        }
      return places;
    }
  } // namespace

  template <int dim>
  std::vector<SurfacePlace<dim>>
  surface_places(const Body<dim> &body, const double spacing)
  {
    if (const auto *box = dynamic_cast<const Shapes::Box<dim> *>(body.shape.get()))
      return places_of_box(*box, spacing);
    std::vector<SurfacePlace<dim>> places;
    for (const auto &facet : body.shape->facets(spacing))
      {
        const auto on = body.shape->nearest(facet.centre()); // of curved shapes facets lie inside or outside
        places.push_back({on.foot, on.normal, facet.area_vector().norm()});
      }
    return places;
  }

  template std::vector<SurfacePlace<2>> surface_places(const Body<2> &, double);
  template std::vector<SurfacePlace<3>> surface_places(const Body<3> &, double);
} // namespace Stroma::Mpm
