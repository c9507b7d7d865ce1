#pragma once

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>

#include <Sacado.hpp>

/// Stress and tangent as derivatives of a strain energy, by nested automatic differentiation: the witness against
/// which the closed forms of the laws are checked.
namespace AutomaticDerivatives
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  /// A law and the strain energy that it should follow from.
  template <typename Law_, typename Energy_>
  struct LawAndEnergy
  {
    using Law    = Law_;
    using Energy = Energy_;
  };

  using First  = Sacado::Fad::SFad<double, 9>;
  using Second = Sacado::Fad::SFad<First, 9>;

  template <typename Number>
  using Matrix = std::array<std::array<Number, 3>, 3>;

  /// C = F^T F.
  template <typename Number>
  Matrix<Number>
  right_cauchy_green(const Matrix<Number> &F)
  {
    Matrix<Number> C;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        C[i][j] = F[0][i] * F[0][j] + F[1][i] * F[1][j] + F[2][i] * F[2][j];
    return C;
  }

  template <typename Number>
  Number
  determinant(const Matrix<Number> &F)
  {
    return F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) - F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0]) +
           F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
  }

  /// kappa/2 (ln J)^2 + mu/2 (J^(-2/3) tr C - 3), Guilkey et al. 2006 eq (12).
  struct NeoHookeanEnergy
  {
    double mu, kappa;

    template <typename Number>
    Number
    operator()(const Matrix<Number> &F) const
    {
      using std::log;
      using std::pow;
      const Matrix<Number> C = right_cauchy_green(F);
      const Number         J = determinant(F), ln_J = log(J), trace = C[0][0] + C[1][1] + C[2][2];
      return .5 * kappa * ln_J * ln_J + .5 * mu * (pow(J, -2. / 3.) * trace - 3.);
    }
  };

  /// lambda/2 (tr E)^2 + mu E:E, E = (C - I)/2.
  struct LinearElasticEnergy
  {
    double mu, kappa;

    template <typename Number>
    Number
    operator()(const Matrix<Number> &F) const
    {
      const double         lambda = kappa - 2. / 3. * mu;
      const Matrix<Number> C      = right_cauchy_green(F);
      Number               trace = 0., square = 0.;
      for (unsigned int i = 0; i < 3; ++i)
        for (unsigned int j = 0; j < 3; ++j)
          {
            const Number E = .5 * (C[i][j] - (i == j ? 1. : 0.));
            square += E * E;
            if (i == j)
              trace += E;
          }
      return .5 * lambda * trace * trace + mu * square;
    }
  };

  /// W, P = dW/dF and A = dP/dF.
  struct Derivatives
  {
    double       W;
    Tensor<2, 3> P;
    Tensor<4, 3> A;
  };

  template <typename Energy>
  Derivatives
  differentiate(const Energy &energy, const Tensor<2, 3> &F)
  {
    Matrix<Second> x;
    for (unsigned int i = 0; i < 9; ++i)
      x[i / 3][i % 3] = Second(9, i, First(9, i, F[i / 3][i % 3]));
    const Second W = energy(x);
    Derivatives  d;
    d.W = W.val().val();
    for (unsigned int i = 0; i < 9; ++i)
      {
        d.P[i / 3][i % 3] = W.dx(i).val();
        for (unsigned int j = 0; j < 9; ++j)
          d.A[i / 3][i % 3][j / 3][j % 3] = W.dx(i).dx(j);
      }
    return d;
  }

  /// tau = P F^T; not yet known to be symmetric.
  inline Tensor<2, 3>
  kirchhoff_stress(const Derivatives &d, const Tensor<2, 3> &F)
  {
    return d.P * transpose(F);
  }

  /// Jc_ijkl = A_iJkL F_jJ F_lL - delta_ik tau_jl.
  inline Tensor<4, 3>
  spatial_tangent(const Derivatives &d, const Tensor<2, 3> &F)
  {
    const Tensor<2, 3> tau = kirchhoff_stress(d, F);
    Tensor<4, 3>       Jc;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int k = 0; k < 3; ++k)
          for (unsigned int l = 0; l < 3; ++l)
            {
              Jc[i][j][k][l] = i == k ? -tau[j][l] : 0.;
              for (unsigned int J = 0; J < 3; ++J)
                for (unsigned int L = 0; L < 3; ++L)
                  Jc[i][j][k][l] += d.A[i][J][k][L] * F[j][J] * F[l][L];
            }
    return Jc;
  }
} // namespace AutomaticDerivatives
