#pragma once

#include <stroma/materials/medium.h>

#include <deal.II/base/tensor.h>

namespace Stroma::Materials
{
  /// Cauchy stress [Pa] of a medium's viscosity, linear in the velocity gradient @p L [1/s], L_ij = dv_i/dx_j; so
  /// viscous_stress(medium, dL) is its derivative along dL. Not symmetric with ViscousOperator::morris.
  inline dealii::Tensor<2, 3>
  viscous_stress(const Medium &medium, const dealii::Tensor<2, 3> &L)
  {
    if (medium.viscous_operator == ViscousOperator::morris)
      return medium.viscosity * L;
    dealii::Tensor<2, 3> stress  = medium.viscosity * (L + transpose(L)); // 2 mu D
    const double         on_tr_D = medium.viscous_operator == ViscousOperator::central ? 5. / 3. - 2. / 3. : -2. / 3.;
    const double         mean    = on_tr_D * medium.viscosity * trace(L);
    for (unsigned int d = 0; d < 3; ++d)
      stress[d][d] += mean;
    return stress;
  }
} // namespace Stroma::Materials
