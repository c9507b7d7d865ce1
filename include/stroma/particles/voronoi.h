#pragma once

#include <stroma/particles/lattice.h>

#include <vector>

namespace Stroma::Particles
{
  /// Particles with their Voronoi cells, the same on all ranks.
  template <int dim>
  struct VoronoiCells
  {
    std::vector<dealii::Point<dim>> centre;             ///< [m]
    std::vector<std::uint64_t>      n_samples;          ///< equal pieces of volume in each cell; a few may have none
    double                          sample_volume = 0.; ///< [m^dim]
  };

  /**
   * Lloyd's iteration (1982) for particles in the scene's material: each goes to the centroid of its cell, until all
   * nearly stay. Cells are those of a power diagram, Voronoi cells with a weight subtracted from each squared distance,
   * and the weights are changed meanwhile such that all cells of a material get the same volume.
   *
   * A cell holds the material of its particle only, so that materials meet between particles. Cells are made of sample
   * points, 8^2 or 6^3 a site of @p lattice, each given to the nearest particle of its material; across periodic faces
   * too. There is a particle a site at the start, at a random place (@p seed) about it. Collective: ranks share the
   * samples; sums are of whole numbers, and so the same on any number of ranks.
   */
  template <int dim>
  VoronoiCells<dim> relaxed_voronoi_cells(const Scene<dim> &scene, const Lattice<dim> &lattice, unsigned int seed);
} // namespace Stroma::Particles
