#pragma once

#include <stroma/materials/medium.h>
#include <stroma/solid/stress_measures.h>

#include <deal.II/base/tensor.h>

namespace Stroma::Fem
{
  /**
   * Viscous stress of a velocity gradient G (G_ij = dv_i/dx_j) in a form that all operators share:
   *   stress = gradient G + transpose G^T + divergence tr(G) I,  all factors in Pa s.
   * Heck et al. 2017, Appendix A (central); (6), with the natural condition mu dv/dn - p n (morris).
   */
  struct StokesViscosity
  {
    explicit StokesViscosity(const Materials::Medium &medium)
    {
      const double mu = medium.viscosity;
      switch (medium.viscous_operator)
        {
          case Materials::ViscousOperator::central: // 2 mu dev D + 5/3 mu tr D I
            gradient = transpose = divergence = mu;
            break;
          case Materials::ViscousOperator::morris:
            gradient = mu;
            break;
          case Materials::ViscousOperator::deviatoric: // 2 mu dev D, the deviator in space
            gradient = transpose = mu;
            divergence           = -2. / 3. * mu;
            break;
        }
    }

    template <int dim>
    dealii::Tensor<2, dim>
    stress(const dealii::Tensor<2, dim> &G) const
    {
      return gradient * G + transpose * dealii::transpose(G) +
             divergence * trace(G) * dealii::unit_symmetric_tensor<dim>();
    }

    /// Von Mises stress of the symmetric part [Pa]; in two dimensions nothing moves along the third.
    template <int dim>
    double
    von_mises(const dealii::Tensor<2, dim> &G) const
    {
      dealii::Tensor<2, 3> in_space;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          in_space[i][j] = G[i][j];
      return Solid::von_mises(symmetrize(stress(in_space)));
    }

    /// Resistance to the rate of a change of volume, as in a longitudinal wave [Pa s].
    double
    p_wave() const
    {
      return gradient + transpose + divergence;
    }

    /// Whether a rigid rotation costs nothing.
    bool
    is_objective() const
    {
      return transpose == gradient;
    }

    double gradient = 0., transpose = 0., divergence = 0.;
  };
} // namespace Stroma::Fem
