#pragma once

#include <stroma/grid/background_grid.h>
#include <stroma/scene/scene.h>

namespace Stroma::Mpm
{
  /// Shares the cells of @p grid out anew, so that the ranks get about as many material points each: a cell weighs what it
  /// holds of the bodies, an empty one nearly nothing. The same on as many ranks, whenever it is done. Collective.
  template <int dim>
  void balance_by_material(BackgroundGrid<dim> &grid, const Scene<dim> &scene);
} // namespace Stroma::Mpm
