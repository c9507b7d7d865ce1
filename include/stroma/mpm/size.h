#pragma once

#include <stroma/mpm/settings.h>
#include <stroma/scene/scene.h>

namespace Stroma::Mpm
{
  /// Throws UserError if grid, points and matrix would need more memory than there is. Returns whether they fit only if cells of a
  /// grid as fine as the image share their stiffness (CellForces::for_each_kind), where it stays matrices of cells. Collective.
  /// @param drives_points whether a motion acts on single points
  /// @param assembled_up_to unknowns up to which the tangent is assembled; of more it stays matrices of cells
  template <int dim>
  bool check_size(const Scene<dim> &scene, const Settings<dim> &settings, const GridBox<dim> &box, bool drives_points,
                  double assembled_up_to);
} // namespace Stroma::Mpm
