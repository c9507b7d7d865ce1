#pragma once

#include <stroma/base/lanes.h>

namespace Stroma
{
  /// Values and gradients at a point of the shape functions of a cell's n nodes, all nodes at once.
  template <int dim, unsigned int n>
  struct Stencil
  {
    Lanes<n>                  value;
    std::array<Lanes<n>, dim> gradient; ///< with respect to the place on the grid [1/m]
  };
} // namespace Stroma
