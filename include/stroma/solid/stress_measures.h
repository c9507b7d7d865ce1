#pragma once

#include <deal.II/base/symmetric_tensor.h>

#include <cmath>

namespace Stroma::Solid
{
  /// sqrt(3/2 s:s), s the deviator.
  inline double
  von_mises(const dealii::SymmetricTensor<2, 3> &stress)
  {
    const auto s = dealii::deviator(stress);
    return std::sqrt(1.5 * (s * s));
  }

  /// Mean compressive stress, -tr/3.
  inline double
  pressure(const dealii::SymmetricTensor<2, 3> &stress)
  {
    return -dealii::trace(stress) / 3.;
  }
} // namespace Stroma::Solid
