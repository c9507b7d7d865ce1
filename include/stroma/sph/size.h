#pragma once

#include <stroma/scene/scene.h>
#include <stroma/sph/settings.h>

namespace Stroma::Sph
{
  /// Throws UserError if the particles would need more memory than there is. Collective.
  template <int dim>
  void check_size(const Scene<dim> &scene, const Settings &settings, bool inertial);
} // namespace Stroma::Sph
