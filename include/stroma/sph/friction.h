#pragma once

#include <stroma/sph/constitution.h>
#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * The friction between particles, Gamma of (14) to (16) in Heck 2017, symmetric and positive semidefinite:
   *   morris:  f_i = -sum_j k_ij (v_i - v_j),                      k_ij = (mu_i + mu_j) V_i V_j F r^2/(r^2 + eta^2),
   *   central: f_i = -(d + 2) sum_j k_ij e (x) e (v_i - v_j),      e = r/|r|, which rigid rotation does not feel.
   * A fixed particle has the viscosity of its neighbour. Segments of published pairs resist motion along them alone, in either form
   * ((27), (28): (v.t) t is v less its part along the normal).
   */
  template <int dim>
  class Friction
  {
  public:
    Friction(const Pairs<dim> &pairs, const std::vector<Constitution> &constitutions, Materials::ViscousOperator form);

    /// Whether the components of velocity are independent of each other.
    bool
    is_isotropic() const
    {
      return form == Materials::ViscousOperator::morris;
    }

    /// For the pairs as they are now.
    void update(const ParticleSet<dim> &particles);

    /// Force of pair @p p on the particle of its row, of velocity difference @p v_ji = v_j - v_i.
    dealii::Tensor<1, dim> pair_force(std::size_t p, const dealii::Tensor<1, dim> &v_ji) const;

    /// f += the forces of velocities @p v with ghosts on free particles [N]: the product that is done most often.
    void add_force(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<dealii::Tensor<1, dim>> &v) const;

    /// What multiplies v_ji in pair_force().
    dealii::SymmetricTensor<2, dim> pair_block(std::size_t p) const;

    /// Adds the diagonal blocks to @p blocks, one a particle.
    void add_diagonal(std::vector<dealii::SymmetricTensor<2, dim>> &blocks, unsigned int n) const;

  private:
    bool
    meets_segment(const std::size_t p) const
    {
      return pairs.has_segments() && pairs.meets_wall_point(p);
    }

    const Pairs<dim>                &pairs;
    const std::vector<Constitution> &constitutions;
    Materials::ViscousOperator       form;
    std::vector<double>              k_along; ///< of wall points that are of segments [Pa s m^(dim - 2)]
    std::vector<double> k; ///< 0 with segments; of each pair [Pa s m^(dim - 2)]; central: times (d + 2)/r^2
  };
} // namespace Stroma::Sph
