#pragma once

#include <stroma/sph/constitution.h>
#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * How far the places of a fluid's particles and their volumes have drifted apart. Volumes are integrated along the motion with
   * the closed gradient, dJ/dt = J tr L, and nothing ties them to places: motions that this gradient does not see (grid-scale
   * ones) move particles together at no cost, a body force finds them, and a tank's level sinks although each particle keeps its
   * volume. What the particles take up where they stand, over what they hold, is
   *   s_i = sum_j V_j W_ij / s_0,     j = i and walls included, s_0 the sum of the undisturbed lattice,
   * 1 at rest, less at free surfaces, more where they are crowded. (Kernel sums as densities: Monaghan 2005, Rep. Prog. Phys. 68,
   * 1703, section 3.) Nothing resists crowding: forces that do let a fluid set, also those of an energy of s that are no larger
   * than what loads leave unbalanced over a spacing.
   */
  template <int dim>
  class Packing
  {
  public:
    static constexpr double not_found = -1.; ///< particles.excess before the first update

    Packing(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const Settings &settings);

    /// For pairs and volumes as they are now; sets particles.excess where it is not_found. @p particles with ghosts.
    void update(Particles<dim> &particles);

    /// Mean of <s_i - 1>, <x> = max(x, 0), weighted by volume, less that of the start: arrangements that are no lattices, and
    /// particles at curved walls, start with some. Collective.
    double mean_excess(const Particles<dim> &particles) const;

  private:
    template <typename KernelType>
    void add_rows(const Particles<dim> &particles, const KernelType &kernel);

    const Pairs<dim>      &pairs;
    const Neighbours<dim> &neighbours;
    const Settings         settings;
    double                 s_0 = 1.;
    std::vector<double>    excess; ///< s - 1 of rows
  };
} // namespace Stroma::Sph
