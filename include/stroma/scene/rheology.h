#pragma once

#include <stroma/scene/scene.h>

#include <algorithm>

namespace Stroma
{
  /// Whether some material of the scene has a viscosity.
  template <int dim>
  bool
  is_viscous(const Scene<dim> &scene)
  {
    return std::any_of(scene.media.begin(), scene.media.end(), [](const auto &medium) { return medium.is_viscous(); });
  }

  /// Numbers that a point of the scene must remember from step to step: as many as the law with the longest memory has.
  template <int dim>
  unsigned int
  n_history(const Scene<dim> &scene)
  {
    unsigned int n = 0;
    for (const auto &law : scene.materials)
      n = std::max(n, law->n_history());
    return n;
  }

  /// Throws UserError for laws with history: time schemes for viscosity and inertia do not take their steps.
  template <int dim>
  void
  refuse_history(const Scene<dim> &scene)
  {
    for (unsigned int m = 0; m < scene.materials.size(); ++m)
      if (scene.materials[m]->n_history() > 0)
        throw UserError(scene.of_material(m),
                        "law '" + scene.materials[m]->name() + "' cannot be combined with a viscosity or inertia");
  }
} // namespace Stroma
