#include <stroma/shapes/path.h>

#include <algorithm>

namespace Stroma::Shapes
{
  template <int dim>
  std::optional<double>
  first_meeting(const Shape<dim> &shape, const dealii::Point<dim> &from, const dealii::Point<dim> &to)
  {
    constexpr double least_step = 1e-4; // away from the surface, or along it
    const auto       path       = to - from;
    const double     length     = path.norm();
    const auto [lower, upper]   = shape.bounding_box().get_boundary_points();
    const double grain          = 1e-13 * lower.distance(upper);
    // As far as the nearest place of the surface is, nothing is met.
    for (double s = 0.;;)
      {
        const auto nearest    = shape.nearest(from + s * path);
        const bool approaches = nearest.normal * path < 0.;
        if (nearest.distance < -grain || (nearest.distance <= grain && approaches))
          return s;
        if (s >= 1. || length == 0.)
          return std::nullopt;
        s = std::min(1., s + std::max(nearest.distance / length, approaches ? 0. : least_step));
      }
  }

  template std::optional<double> first_meeting(const Shape<2> &, const dealii::Point<2> &, const dealii::Point<2> &);
  template std::optional<double> first_meeting(const Shape<3> &, const dealii::Point<3> &, const dealii::Point<3> &);
} // namespace Stroma::Shapes
