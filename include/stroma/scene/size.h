#pragma once

#include <stroma/scene/scene.h>

namespace Stroma
{
  /// Volume (area in 2D) of the bodies' material as a lattice of places shows it, within some per cent [m^dim]: for
  /// estimates of sizes before anything is made.
  template <int dim>
  double estimated_volume(const Scene<dim> &scene);
} // namespace Stroma
