#pragma once

#include <stroma/materials/material.h>

#include <vector>

namespace Stroma::Materials
{
  /// Jc [Pa] of a law at F = I before anything happened; of one with history the instantaneous one.
  inline dealii::SymmetricTensor<4, 3>
  reference_tangent(const Material &law)
  {
    const dealii::Tensor<2, 3>    identity(dealii::unit_symmetric_tensor<3>());
    dealii::SymmetricTensor<4, 3> C;
    const std::vector<double>     history(law.n_history(), 0.);
    law.evaluate({{&identity, 1}, dealii::make_array_view(history), 0.}, {{}, {&C, 1}, {}, {}, {}});
    return C;
  }
} // namespace Stroma::Materials
