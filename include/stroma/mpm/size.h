#pragma once

#include <stroma/mpm/settings.h>
#include <stroma/scene/scene.h>

namespace Stroma::Mpm
{
  /// Throws UserError if grid, points and matrix would need more memory than there is. Collective.
  /// @param drives_points whether a motion acts on single points
  template <int dim>
  void check_size(const Scene<dim> &scene, const Settings<dim> &settings, const GridBox<dim> &box, bool drives_points);
} // namespace Stroma::Mpm
