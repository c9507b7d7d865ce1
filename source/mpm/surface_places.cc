#include <stroma/mpm/surface_places.h>

#include <cmath>

namespace Stroma::Mpm
{
  namespace
  {
    /// Equal parts of a circle, or of a sphere along a spiral (Fibonacci's), which are about @p spacing wide.
    template <int dim>
    std::vector<SurfacePlace<dim>>
    places_of_ball(const Body<dim> &body, const double spacing)
    {
      const double                   pi = dealii::numbers::PI, r = body.radius;
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
          places.push_back({body.first + r * normal, normal, area / n});
        }
      return places;
    }

    /// Equal parts of the sides of a box.
    template <int dim>
    std::vector<SurfacePlace<dim>>
    places_of_box(const Body<dim> &body, const double spacing)
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
              const double edge = body.second[d] - body.first[d];
              n[d]              = d == axis ? 1 : std::ceil(edge / spacing);
              all *= n[d];
              area *= d == axis ? 1. : edge / n[d];
            }
          for (unsigned int i = 0; i < all; ++i)
            {
              SurfacePlace<dim> place{body.first, {}, area};
              for (unsigned int d = 0, rest = i; d < dim; rest /= n[d++])
                place.X[d] += d == axis ? (side % 2) * (body.second[d] - body.first[d]) :
                                          (rest % n[d] + .5) * (body.second[d] - body.first[d]) / n[d];
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
    return body.shape == Body<dim>::Shape::ball ? places_of_ball(body, spacing) : places_of_box(body, spacing);
  }

  template std::vector<SurfacePlace<2>> surface_places(const Body<2> &, double);
  template std::vector<SurfacePlace<3>> surface_places(const Body<3> &, double);
} // namespace Stroma::Mpm
