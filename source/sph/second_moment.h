#pragma once

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <cmath>

namespace Stroma::Sph
{
  /// Whether neighbours with second moment @p moment, sum P r (x) r, lie in enough directions to tell a gradient: its determinant over
  /// that of an even one of the same trace.
  template <typename Moment>
  bool
  tells_gradient(const Moment &moment)
  {
    constexpr double least_determinant = 1e-3;
    constexpr int    dim               = Moment::dimension;
    return determinant(moment) > least_determinant * std::pow(trace(moment) / dim, dim);
  }
} // namespace Stroma::Sph
