#include <stroma/mpm/surface_places.h>
#include <stroma/shapes/ball.h>
#include <stroma/shapes/box.h>

#include <cmath>

namespace Stroma::Mpm
{
  namespace
  {
    /// Equal parts of a circle, or of a sphere along a spiral (Fibonacci's), which are about @p spacing wide.
    template <int dim>
    std::vector<SurfacePlace<dim>>
    places_of_ball(const Shapes::Ball<dim> &ball, const double spacing)
    {
      const double                   pi = dealii::numbers::PI, r = ball.radius;
      const double                   area = dim == 2 ? 2. * pi * r : 4. * pi * r * r;
      const unsigned int             n    = std::max(4 * dim, int(std::ceil(area / std::pow(spacing, dim - 1))));
      const double                   turn = dim == 2 ? 2. * pi / n : pi * (3. - std::sqrt(5.));
      std::vector<SurfacePlace<dim>> places;
      for (unsigned int i = 0; i < n; ++i)
        {
          dealii::Tensor<1, dim> normal;
          const double           z = dim == 2 ? 0. : 1. - (2. * i + 1.) / n, ring = std::sqrt(1. - z * z);
          normal[0] = ring * std::cos((i + .5) * turn);
          normal[1] = ring * std::sin((i + .5) * turn);
          if (dim == 3)
            normal[dim - 1] = z;
          places.push_back({ball.centre + r * normal, normal, area / n});
        }
      return places;
    }

    /// Equal parts of the sides of a box.
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
    if (const auto *ball = dynamic_cast<const Shapes::Ball<dim> *>(body.shape.get()))
      return places_of_ball(*ball, spacing);
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
