#include <stroma/shapes/path.h>

#include <algorithm>

namespace Stroma::Shapes
{
  namespace
  {
    /// Where on the path the inside begins, between parameters that are outside and inside.
    template <int dim>
    double
    first_inside(const Shape<dim> &shape, const dealii::Point<dim> &from, const dealii::Tensor<1, dim> &path,
                 double outside, double inside, const double grain)
    {
      for (int round = 0; round < 50; ++round)
        {
          const double middle                                                        = .5 * (outside + inside);
          (shape.nearest(from + middle * path).distance < -grain ? inside : outside) = middle;
        }
      return inside;
    }
  } // namespace

  template <int dim>
  std::optional<double>
  first_meeting(const Shape<dim> &shape, const dealii::Point<dim> &from, const dealii::Point<dim> &to)
  {
    constexpr double least_step = 1e-4; // what is thinner may be passed through
    const auto       path       = to - from;
    const double     length     = path.norm();
    const auto [lower, upper]   = shape.bounding_box().get_boundary_points();
    const double grain          = 1e-13 * lower.distance(upper);
    // As far as the nearest place of the surface is, nothing is met.
    for (double s = 0., outside = 0.;;)
      {
        const auto nearest = shape.nearest(from + s * path);
        if (nearest.distance < -grain)
          return s > outside ? first_inside(shape, from, path, outside, s, grain) : s;
        if (nearest.distance <= grain && nearest.normal * path < 0.)
          return s;
        if (s >= 1. || length == 0.)
          return std::nullopt;
        outside = s;
        s       = std::min(1., s + std::max(nearest.distance / length, least_step));
      }
  }

  template std::optional<double> first_meeting(const Shape<2> &, const dealii::Point<2> &, const dealii::Point<2> &);
  template std::optional<double> first_meeting(const Shape<3> &, const dealii::Point<3> &, const dealii::Point<3> &);
} // namespace Stroma::Shapes
