#include <stroma/particles/arrangement.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Particles
{
  namespace
  {
    /// Share of the interval of length @p size about @p x that lies between @p lower and @p upper.
    double
    share_of_interval(const double x, const double size, const double lower, const double upper)
    {
      return std::max(0., std::min(x + size / 2., upper) - std::max(x - size / 2., lower)) / size;
    }

    template <int dim>
    double
    share_in_ball(const Region<dim> &region, const dealii::Point<dim> &X, const double spacing)
    {
      constexpr int along_axis = dim == 2 ? 16 : 6, n = dim == 2 ? 16 * 16 : 6 * 6 * 6;
      const double  gap = X.distance(region.first) - region.extent;
      if (std::abs(gap) > spacing * std::sqrt(double(dim)) / 2.)
        return gap < 0. ? 1. : 0.;
      int n_inside = 0;
      for (int i = 0; i < n; ++i)
        {
          double square = 0.;
          for (int d = 0, rest = i; d < dim; ++d, rest /= along_axis)
            {
              const double x = X[d] + spacing * ((rest % along_axis + .5) / along_axis - .5) - region.first[d];
              square += x * x;
            }
          n_inside += square <= region.extent * region.extent;
        }
      return n_inside / double(n);
    }
  } // namespace

  template <int dim>
  double
  share_in_region(const Scene<dim> &scene, const Region<dim> &region, const dealii::Point<dim> &X,
                  const unsigned int material, const double spacing)
  {
    switch (region.kind)
      {
        case Region<dim>::Kind::ball:
          return share_in_ball(region, X, spacing);
          case Region<dim>::Kind::box: {
            double share = 1.;
            for (unsigned int d = 0; d < dim; ++d)
              share *= share_of_interval(X[d], spacing, region.first[d], region.second[d]);
            return share;
          }
          case Region<dim>::Kind::layer: {
            const auto bounds = region.bounds(scene.bounding_box());
            return share_of_interval(X[region.axis], spacing, bounds.lower_bound(region.axis),
                                     bounds.upper_bound(region.axis));
          }
        case Region<dim>::Kind::all:
        case Region<dim>::Kind::material:
          return region.contains(X, material, scene.bounding_box()) ? 1. : 0.;
        case Region<dim>::Kind::nearest: // one particle of all, which the caller must find
        case Region<dim>::Kind::side:
        case Region<dim>::Kind::rim:
        case Region<dim>::Kind::body:
          return 0.;
      }
    return 0.;
  }

  template double share_in_region(const Scene<2> &, const Region<2> &, const dealii::Point<2> &, unsigned int, double);
  template double share_in_region(const Scene<3> &, const Region<3> &, const dealii::Point<3> &, unsigned int, double);
} // namespace Stroma::Particles
