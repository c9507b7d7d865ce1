#include <stroma/base/text.h>
#include <stroma/scene/reactions.h>

#include <cmath>
#include <limits>
#include <optional>

namespace Stroma
{
  namespace
  {
    constexpr double round_off = 1e-12; ///< strain that is none, as of a cycle that has come back

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

    /// The support that prescribes the displacement of one end of the bodies along @p axis, a side or layer there; nullptr: none.
    template <int dim>
    const Support<dim> *
    end_support(const Scene<dim> &scene, const unsigned int axis, const bool upper, const unsigned int component)
    {
      using Kind     = typename Region<dim>::Kind;
      const auto box = scene.bounding_box();
      for (const auto &support : scene.supports)
        if ((support.region.kind == Kind::side || support.region.kind == Kind::layer) && support.displacement.given() &&
            is_at_end(support.region, axis, upper, box) && !support.displacement.is_free(component))
          return &support;
      return nullptr;
    }

    /// Component of the prescribed displacement of one end along @p axis at its middle [m], where a side or layer has one.
    template <int dim>
    std::optional<double>
    end_displacement(const Scene<dim> &scene, const unsigned int axis, const bool upper, const unsigned int component,
                     const double t)
    {
      const auto *support = end_support(scene, axis, upper, component);
      if (!support)
        return {};
      const auto box = scene.bounding_box();
      auto       end = box.center();
      end[axis]      = support->region.side_coordinate(box);
      return support->displacement.value(end, t, component);
    }

    /// By how much the ends along @p axis move apart in direction @p component, over their distance. At t = 0, when nothing is
    /// displaced yet, not at all, whatever is prescribed.
    template <int dim>
    std::optional<double>
    strain(const Scene<dim> &scene, const unsigned int axis, const unsigned int component, const double t)
    {
      const auto upper = end_displacement(scene, axis, true, component, t);
      if (!upper)
        return {};
      if (t <= 0.)
        return 0.;
      return (*upper - end_displacement(scene, axis, false, component, t).value_or(0.)) /
             scene.bounding_box().side_length(axis);
    }

    /// Of the specimen's box, across @p axis [m^2].
    template <int dim>
    double
    section(const Scene<dim> &scene, const unsigned int axis)
    {
      const auto box  = scene.bounding_box();
      double     area = dim == 2 ? scene.thickness : 1.;
      for (unsigned int d = 0; d < dim; ++d)
        if (d != axis)
          area *= box.side_length(d);
      return area;
    }

    /// Component of the force of all supports at the upper end along @p axis [N].
    template <int dim>
    double
    force_at_upper_end(const Scene<dim> &scene, const unsigned int axis, const unsigned int component,
                       const std::vector<dealii::Tensor<1, dim>> &reactions)
    {
      const auto box   = scene.bounding_box();
      double     force = 0.;
      for (unsigned int s = 0; s < scene.supports.size(); ++s)
        if (const auto &support = scene.supports[s];
            support.holds(component) && is_at_end(support.region, axis, true, box))
          force += reactions[s][component];
      return force;
    }

    /// What a test machine would tell of an upper end that moves along its axis or across it.
    template <int dim>
    void
    add_moduli(const Scene<dim> &scene, const std::vector<dealii::Tensor<1, dim>> &reactions, const double t,
               std::vector<std::pair<std::string, double>> &scalars)
    {
      for (unsigned int axis = 0; axis < dim; ++axis)
        for (unsigned int c = 0; c < dim; ++c)
          {
            if (!driving_support(scene, axis, c))
              continue;
            const bool        shears = c != axis;
            const std::string name   = shears ? std::string{"xyz"[c], "xyz"[axis]} : std::string(1, "xyz"[axis]);
            const double      gamma  = *strain(scene, axis, c, t);
            const double      stress = force_at_upper_end(scene, axis, c, reactions) / section(scene, axis);
            if (shears)
              scalars.emplace_back("shear_strain_" + name, gamma);
            scalars.emplace_back((shears ? "shear_stress_" : "nominal_stress_") + name + "_Pa", stress);
            scalars.emplace_back("apparent_modulus_" + name + "_Pa", std::abs(gamma) < round_off ?
                                                                       std::numeric_limits<double>::quiet_NaN() :
                                                                       stress / gamma);
          }
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
  const Support<dim> *
  driving_support(const Scene<dim> &scene, const unsigned int axis, const unsigned int component)
  {
    const auto *support = end_support(scene, axis, true, component);
    return support && support->displacement.depends_on_time(component) ? support : nullptr;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<dim> &scene, const std::vector<dealii::Tensor<1, dim>> &reactions, const double t)
  {
    std::vector<std::pair<std::string, double>> scalars;
    const auto name = [](const unsigned int axis) { return std::string(1, "xyz"[axis]); };
    for (unsigned int axis = 0; axis < dim; ++axis)
      if (const auto along = strain(scene, axis, axis, t))
        scalars.emplace_back("strain_" + name(axis), *along);
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      for (unsigned int c = 0; c < dim; ++c)
        if (scene.supports[s].holds(c))
          scalars.emplace_back("reaction_" + scene.supports[s].name + "_" + name(c) + "_N", reactions[s][c]);
    for (unsigned int axis = 0; axis < dim; ++axis)
      if (const auto force = force_at_lower_end(scene, axis, reactions))
        scalars.emplace_back("reaction_force_" + name(axis) + "_N", *force);
    add_moduli(scene, reactions, t, scalars);
    return scalars;
  }

  template <int dim>
  bool
  has_driven_end(const Scene<dim> &scene)
  {
    for (unsigned int axis = 0; axis < dim; ++axis)
      for (unsigned int c = 0; c < dim; ++c)
        if (driving_support(scene, axis, c))
          return true;
    return false;
  }

  bool
  is_modulus_at_rest(const std::string &name, const double value)
  {
    return std::isnan(value) && name.rfind("apparent_modulus_", 0) == 0;
  }

  template <int dim>
  std::map<std::string, double>
  specimen_results(const Scene<dim> &scene)
  {
    std::map<std::string, double> results;
    for (unsigned int axis = 0; axis < dim; ++axis)
      {
        results[std::string("box_") + "xyz"[axis] + "_m"]      = scene.bounding_box().side_length(axis);
        results[std::string("section_") + "xyz"[axis] + "_m2"] = section(scene, axis);
      }
    return results;
  }

  template std::vector<std::pair<std::string, double>>
  reaction_scalars(const Scene<2> &, const std::vector<dealii::Tensor<1, 2>> &, double);
  template std::vector<std::pair<std::string, double>>
                             reaction_scalars(const Scene<3> &, const std::vector<dealii::Tensor<1, 3>> &, double);
  template const Support<2> *driving_support(const Scene<2> &, unsigned int, unsigned int);
  template const Support<3> *driving_support(const Scene<3> &, unsigned int, unsigned int);
  template bool              has_driven_end(const Scene<2> &);
  template bool              has_driven_end(const Scene<3> &);
  template std::map<std::string, double> specimen_results(const Scene<2> &);
  template std::map<std::string, double> specimen_results(const Scene<3> &);
} // namespace Stroma
