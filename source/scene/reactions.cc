#include <stroma/base/text.h>
#include <stroma/scene/reactions.h>

#include <cmath>
#include <optional>

namespace Stroma
{
  namespace
  {
    /// Whether the support acts at one end of the bodies along @p axis: its side, a layer there or a box that takes it in.
    template <int dim>
    bool
    is_at_end(const Region<dim> &region, const unsigned int axis, const bool upper,
              const dealii::BoundingBox<dim> &bodies)
    {
      using Kind = typename Region<dim>::Kind;
      if (region.kind == Kind::side || region.kind == Kind::layer)
        return region.axis == axis && region.upper == upper;
      if (region.kind != Kind::box)
        return false;
      const double tolerance = 1e-9 * bodies.side_length(axis);
      const bool   lower_end = region.first[axis] <= bodies.lower_bound(axis) + tolerance;
      const bool   upper_end = region.second[axis] >= bodies.upper_bound(axis) - tolerance;
      return upper ? upper_end && !lower_end : lower_end && !upper_end;
    }

    /// The prescribed displacement of one end of the bodies along @p axis at its middle [m], where a side or layer has one.
    template <int dim>
    std::optional<double>
    end_displacement(const Scene<dim> &scene, const unsigned int axis, const bool upper, const double t)
    {
      using Kind     = typename Region<dim>::Kind;
      const auto box = scene.bounding_box();
      for (const auto &support : scene.supports)
        if ((support.region.kind == Kind::side || support.region.kind == Kind::layer) && support.displacement.given() &&
            is_at_end(support.region, axis, upper, box) && !support.displacement.is_free(axis))
          {
            auto end  = box.center();
            end[axis] = support.region.side_coordinate(box);
            return support.displacement.value(end, t, axis);
          }
      return {};
    }

    /// Magnitude of the force along @p axis of all supports at the lower end, if its side is held [N].
    template <int dim>
    std::optional<double>
    force_at_lower_end(const Scene<dim> &scene, const unsigned int axis,
                       const std::vector<dealii::Tensor<1, dim>> &reactions)
    {
      const auto box        = scene.bounding_box();
      bool       holds_side = false;
      double     force      = 0;
      for (unsigned int s = 0; s < scene.supports.size(); ++s)
        if (const auto &support = scene.supports[s]; support.holds(axis) && is_at_end(support.region, axis, false, box))
          {
            holds_side |= support.region.kind == Region<dim>::Kind::side;
            force += reactions[s][axis];
          }
      return holds_side ? std::optional<double>(std::abs(force)) : std::nullopt;
    }
  } // namespace

  template <int dim>
  std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<dim> &scene, const std::vector<dealii::Tensor<1, dim>> &reactions, const double t)
  {
    std::vector<std::pair<std::string, double>> scalars;
    const auto                                  box = scene.bounding_box();
    const auto name = [](const unsigned int axis) { return std::string(1, "xyz"[axis]); };
    for (unsigned int axis = 0; axis < dim; ++axis)
      if (const auto upper = end_displacement(scene, axis, true, t))
        scalars.emplace_back("strain_" + name(axis),
                             (*upper - end_displacement(scene, axis, false, t).value_or(0.)) / box.side_length(axis));
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      for (unsigned int c = 0; c < dim; ++c)
        if (scene.supports[s].holds(c))
          scalars.emplace_back("reaction_" + scene.supports[s].name + "_" + name(c) + "_N", reactions[s][c]);
    for (unsigned int axis = 0; axis < dim; ++axis)
      if (const auto force = force_at_lower_end(scene, axis, reactions))
        scalars.emplace_back("reaction_force_" + name(axis) + "_N", *force);
    return scalars;
  }

  template std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<2> &, const std::vector<dealii::Tensor<1, 2>> &, double);
  template std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<3> &, const std::vector<dealii::Tensor<1, 3>> &, double);
} // namespace Stroma
