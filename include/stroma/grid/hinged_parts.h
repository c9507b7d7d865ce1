#pragma once

#include <stroma/grid/background_grid.h>

namespace Stroma
{
  /// Number of parts in which the cells that carry unknowns hang together: cells that share a node belong to one part.
  /// Does not depend on the number of ranks. Collective.
  template <int dim>
  unsigned int n_hinged_parts(const BackgroundGrid<dim> &grid);
} // namespace Stroma
