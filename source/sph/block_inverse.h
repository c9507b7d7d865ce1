#pragma once

#include <deal.II/base/tensor.h>

namespace Stroma::Sph
{
  /// Inverse of a positive definite block by the Schur complement of its first row; deal.II's ends at 3 x 3.
  template <int dim>
  dealii::Tensor<2, dim + 1>
  inverse_of(const dealii::Tensor<2, dim + 1> &block)
  {
    dealii::Tensor<2, dim> rest;
    dealii::Tensor<1, dim> first;
    for (unsigned int a = 0; a < dim; ++a)
      {
        first[a] = block[0][a + 1];
        for (unsigned int b = 0; b < dim; ++b)
          rest[a][b] = block[a + 1][b + 1];
      }
    rest                                = invert(rest);
    const dealii::Tensor<1, dim> folded = rest * first;
    dealii::Tensor<2, dim + 1>   inverse;
    inverse[0][0] = 1. / (block[0][0] - folded * first);
    for (unsigned int a = 0; a < dim; ++a)
      {
        inverse[0][a + 1] = inverse[a + 1][0] = -inverse[0][0] * folded[a];
        for (unsigned int b = 0; b < dim; ++b)
          inverse[a + 1][b + 1] = rest[a][b] + inverse[0][0] * folded[a] * folded[b];
      }
    return inverse;
  }
} // namespace Stroma::Sph
