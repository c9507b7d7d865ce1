#pragma once

#include <stroma/sph/system.h>

namespace Stroma::Sph
{
  /// Free particles that no chain of pairs connects with a wall, a held particle or, where a scene has neither, with the
  /// particle of the lowest id: without inertia nothing tells how they move.
  template <int dim>
  struct Islands
  {
    std::uint64_t      n_particles = 0;
    dealii::Point<dim> X; ///< undeformed place of the one with the lowest id [m]
  };

  /// Those of the pairs as they are. Collective.
  template <int dim>
  Islands<dim> find_islands(const System<dim> &system);
} // namespace Stroma::Sph
