#pragma once

#include <stroma/sph/constitution.h>
#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * Keeps the places of a fluid's particles and their volumes together. Volumes are integrated along the motion with the closed
   * gradient, dJ/dt = J tr L, and nothing ties them to places: motions that this gradient does not see (grid-scale ones) move
   * particles together at no cost, and where a flow stretches, they line up along its streamlines. What the particles take up where
   * they stand, over what they hold, is
   *   s_i = sum_j V_j W_ij / s_0,     j = i and walls included, s_0 the sum of the undisturbed lattice,
   * 1 at rest, less at free surfaces, more where they are crowded. (Kernel sums as densities: Monaghan 2005, Rep. Prog. Phys. 68,
   * 1703, section 3.)
   *
   * Particles that move are shifted out of crowded places, at most as far as they have moved,
   *   dx_i = -A h |v_i| dt/V_i sum_j (e_i + e_j) P_ij r_ij,     e = <s - 1>, <x> = max(x, 0), A = 5,
   * with the pairs as they were found: places of ghosts, and of images across periodic faces, are older than those of owned particles,
   * and take on the volume ratio and velocity of where they come to. (Shifts in proportion to the speed: Skillen, Lind, Stansby,
   * Rogers 2013, Comput. Meth. Appl. Mech. Eng. 265, 163, with A = 1 to 6.) A shift is no force: forces against crowding, also
   * weak ones of an energy of s, let a fluid set. The price is that a particle of a fluid marks a place, not a piece of matter.
   * Where the mean excess grows all the same, the run ends.
   */
  template <int dim>
  class Packing
  {
  public:
    static constexpr double not_found = -1.; ///< particles.excess before the first update

    Packing(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const Settings &settings);

    /// For pairs and volumes as they are now; sets particles.excess where it is not_found. @p particles with ghosts. Collective.
    void update(ParticleSet<dim> &particles);

    /// Mean of <s_i - 1>, <x> = max(x, 0), weighted by volume, less that of the start: arrangements that are no lattices, and
    /// particles at curved walls, start with some. Collective.
    double mean_excess(const ParticleSet<dim> &particles) const;

    /// Shifts of the owned free particles, which have moved with velocities @p v over @p dt [m]. Local.
    std::vector<dealii::Tensor<1, dim>> shifts(const ParticleSet<dim>                    &particles,
                                               const std::vector<dealii::Tensor<1, dim>> &v, double dt) const;

    /// Gradient of @p field, ghosts included, at free particle @p i: that of least squares over its free neighbours of the same
    /// material, 0 where they do not tell one.
    dealii::Tensor<1, dim> gradient(const ParticleSet<dim> &particles, unsigned int i,
                                    const std::vector<double> &field) const;

  private:
    static constexpr double shift_strength = 5.; ///< A

    template <typename KernelType>
    void add_rows(const ParticleSet<dim> &particles, const KernelType &kernel);

    const Pairs<dim>      &pairs;
    const Neighbours<dim> &neighbours;
    const Settings         settings;
    double                 s_0 = 1.;
    std::vector<double>    excess;   ///< s - 1 of rows
    std::vector<double>    crowding; ///< e; ghosts included
  };
} // namespace Stroma::Sph
