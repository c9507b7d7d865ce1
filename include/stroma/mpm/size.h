#pragma once

#include <stroma/mpm/settings.h>
#include <stroma/scene/scene.h>

namespace Stroma::Mpm
{
  /// Throws UserError if grid, points and matrix would need more memory than there is. Collective.
  /// @param drives_points whether a motion acts on single points
  /// @param assembled_up_to unknowns up to which the tangent is assembled; of more it stays matrices of cells
  template <int dim>
  void check_size(const Scene<dim> &scene, const Settings<dim> &settings, const GridBox<dim> &box, bool drives_points,
                  double assembled_up_to);
} // namespace Stroma::Mpm
