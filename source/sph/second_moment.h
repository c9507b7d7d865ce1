#pragma once

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <cmath>

namespace Stroma::Sph
{
  /// @p moment += P r (x) r.
  template <int dim>
  void
  add_moment(dealii::SymmetricTensor<2, dim> &moment, const double P, const dealii::Tensor<1, dim> &r)
  {
    for (unsigned int k = 0; k < dim; ++k)
      for (unsigned int l = 0; l <= k; ++l)
        moment[k][l] += P * r[k] * r[l];
  }

  /// Whether neighbours with second moment @p moment, sum P r (x) r, lie in enough directions to tell a gradient: its determinant over
  /// that of an even one of the same trace. The least is that of neighbours within .02 of a spacing of a line (in three dimensions of a
  /// line or plane), as places of pairs are followed to .001: nearer to it an inverse would make gradients of that.
  template <typename Moment>
  bool
  tells_gradient(const Moment &moment)
  {
    constexpr double least_determinant = 1e-3;
    constexpr int    dim               = Moment::dimension;
    return determinant(moment) > least_determinant * std::pow(trace(moment) / dim, dim);
  }
} // namespace Stroma::Sph
