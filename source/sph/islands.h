#pragma once

#include <stroma/sph/system.h>

namespace Stroma::Sph
{
  /// Free particles that no chain of pairs connects with a wall, a held particle or, where a scene has neither, with the
  /// particle of the lowest id: without inertia nothing tells how they move. Nor do rigid bodies hold that the balance of forces
  /// moves, unless they touch what is held or have a drag.
  template <int dim>
  struct Islands
  {
    std::uint64_t      n_particles = 0;
    dealii::Point<dim> X;    ///< undeformed place of the one with the lowest id [m]
    std::string        body; ///< a rigid body of that kind, "" if there is none
  };

  /// Those of the pairs as they are. Collective.
  template <int dim>
  Islands<dim> find_islands(const System<dim> &system);
} // namespace Stroma::Sph
