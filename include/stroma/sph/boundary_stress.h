#pragma once

#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * Stress on the surfaces of rigid bodies in the published scheme (Heck 2017, 2.5.4). That of a boundary particle b is the kernel's
   * mean over the material that touches the body,
   *   rho_b   = sum_j m_j W_jb/sum_j V_j W_jb,                                                     (30)
   *   sigma_b = rho_b sum_j V_j (sigma_j/rho_j + a_j.r_jb I) W_jb/sum_j V_j W_jb,                  (31), (32)
   * a_j the acceleration by the body force, r_jb = x_j - x_b; the velocities in (31) have no place where nothing has inertia. A
   * segment has the mean of its ends: what row i sees of a wall has the mean, weighted with W_ib, of the boundary particles on it.
   */
  template <int dim>
  class BoundaryStress
  {
  public:
    using Stresses = std::vector<dealii::SymmetricTensor<2, dim>>;

    BoundaryStress(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const Settings &settings);

    /// Whether particle @p i is a boundary particle.
    bool gives(const ParticleSet<dim> &particles, unsigned int i) const;

    /// Sets those of boundary particles in @p sigma, of particles and ghosts, and adds those of the wall points [Pa].
    /// @param body_forces on free particles of this rank [N]; empty: none. Collective.
    void add(Stresses &sigma, const ParticleSet<dim> &particles,
             const std::vector<dealii::Tensor<1, dim>> &body_forces) const;

  private:
    template <typename KernelType>
    dealii::SymmetricTensor<2, dim>
    at_particle(unsigned int b, const Stresses &sigma, const ParticleSet<dim> &particles,
                const std::vector<dealii::Tensor<1, dim>> &forces, const KernelType &kernel) const;
    template <typename KernelType>
    dealii::SymmetricTensor<2, dim> at_segments(unsigned int i, std::size_t p, const Stresses &sigma,
                                                const ParticleSet<dim> &particles, const KernelType &kernel) const;

    const Pairs<dim>      &pairs;
    const Neighbours<dim> &neighbours;
    const Settings         settings;
  };
} // namespace Stroma::Sph
