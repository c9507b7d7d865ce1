#pragma once

#include <stroma/materials/medium.h>

#include <deal.II/base/tensor.h>

namespace Stroma::Materials
{
  /// What a medium's viscous stress is made of [Pa s]: on_L L + on_transposed L^T + on_trace tr L I, with the velocity gradient
  /// L_ij = dv_i/dx_j.
  struct ViscousModuli
  {
    double on_L = 0., on_transposed = 0., on_trace = 0.;
  };

  inline ViscousModuli
  viscous_moduli(const Medium &medium)
  {
    const double mu = medium.viscosity;
    switch (medium.viscous_operator)
      {
        case ViscousOperator::morris:
          return {mu, 0., 0.};
        case ViscousOperator::deviatoric:
          return {mu, mu, -2. / 3. * mu};
        default:
          return {mu, mu, (5. / 3. - 2. / 3.) * mu};
      }
  }

  /// Cauchy stress [Pa] of a medium's viscosity, linear in the velocity gradient @p L [1/s]; so viscous_stress(medium, dL) is its
  /// derivative along dL. Not symmetric with ViscousOperator::morris.
  inline dealii::Tensor<2, 3>
  viscous_stress(const Medium &medium, const dealii::Tensor<2, 3> &L)
  {
    const auto           moduli = viscous_moduli(medium);
    dealii::Tensor<2, 3> stress = moduli.on_L * L + moduli.on_transposed * transpose(L);
    const double         mean   = moduli.on_trace * trace(L);
    for (unsigned int d = 0; d < 3; ++d)
      stress[d][d] += mean;
    return stress;
  }
} // namespace Stroma::Materials
