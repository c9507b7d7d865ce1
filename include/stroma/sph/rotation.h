#pragma once

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

namespace Stroma::Sph
{
  /// Rotation in a step of length @p dt with velocity gradient @p L, (I - dt W/2)^-1 (I + dt W/2), W the spin: exactly
  /// orthogonal (Hughes & Winget 1980).
  template <int dim>
  dealii::Tensor<2, dim>
  hughes_winget(const dealii::Tensor<2, dim> &L, const double dt)
  {
    if constexpr (dim == 2)
      {
        const double           w = .25 * dt * (L[0][1] - L[1][0]), size = 1. / (1. + w * w);
        dealii::Tensor<2, dim> Q;
        Q[0][0] = Q[1][1] = (1. - w * w) * size;
        Q[0][1]           = 2. * w * size;
        Q[1][0]           = -Q[0][1];
        return Q;
      }
    const dealii::Tensor<2, dim> half = .25 * dt * (L - transpose(L));
    const dealii::Tensor<2, dim> I    = dealii::unit_symmetric_tensor<dim>();
    return invert(I - half) * (I + half);
  }

  /// Q s Q^T.
  template <int dim>
  dealii::SymmetricTensor<2, dim>
  rotated(const dealii::SymmetricTensor<2, dim> &s, const dealii::Tensor<2, dim> &Q)
  {
    const auto                      Qs = Q * dealii::Tensor<2, dim>(s);
    dealii::SymmetricTensor<2, dim> result;
    for (unsigned int k = 0; k < dim; ++k)
      for (unsigned int l = 0; l <= k; ++l)
        result[k][l] = Qs[k] * Q[l];
    return result;
  }

  /// Of its eigenvalues, which must be positive, in its axes.
  template <int dim>
  dealii::SymmetricTensor<2, dim>
  logarithm(const dealii::SymmetricTensor<2, dim> &A)
  {
    dealii::SymmetricTensor<2, dim> result;
    for (const auto &[value, axis] : dealii::eigenvectors(A, dealii::SymmetricTensorEigenvectorMethod::jacobi))
      result += std::log(value) * symmetrize(outer_product(axis, axis));
    return result;
  }

  /// W s - s W, the increment of s with the spin W = (L - L^T)/2 in the Jaumann rate, (11) of Heck 2017.
  template <int dim>
  dealii::SymmetricTensor<2, dim>
  jaumann_spin(const dealii::SymmetricTensor<2, dim> &s, const dealii::Tensor<2, dim> &L)
  {
    const dealii::Tensor<2, dim> W = .5 * (L - transpose(L)), full(s);
    return symmetrize(W * full - full * W);
  }
} // namespace Stroma::Sph
