#pragma once

#include <stroma/particles/lattice.h>
#include <stroma/particles/particle_set.h>

namespace Stroma::Particles
{
  /// @p X moved into the scene's box by whole periods.
  template <int dim>
  dealii::Point<dim> inside_periods(const Scene<dim> &scene, dealii::Point<dim> X);

  /**
   * Volumes of the particles of a lattice over those of its cells, where borders between materials are followed. A cell that such a
   * border cuts belongs to the particle of the material at its site; here the part beyond the border goes to the nearest particle
   * of the material there, so that the particles of a material stand for what it takes up, not for a staircase. Measured by 16
   * (in 3D 6) samples along each edge. What has no such particle in the next cells stays, so the sum is that of whole cells.
   * Local. @param particles all of them free
   */
  template <int dim>
  std::vector<double> shares_at_borders(const Scene<dim> &scene, const Lattice<dim> &lattice,
                                        const ParticleSet<dim> &particles);
} // namespace Stroma::Particles
