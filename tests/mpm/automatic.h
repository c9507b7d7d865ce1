#pragma once

#include <Sacado.hpp>

#include <array>

// Stresses that differentiate themselves, written independently of the program.

using AD = Sacado::Fad::DFad<double>;

using Matrix3 = std::array<std::array<AD, 3>, 3>;

inline Matrix3
product(const Matrix3 &A, const Matrix3 &B, const bool transpose_B)
{
  Matrix3 C;
  for (unsigned int i = 0; i < 3; ++i)
    for (unsigned int k = 0; k < 3; ++k)
      for (unsigned int l = 0; l < 3; ++l)
        C[i][k] += A[i][l] * (transpose_B ? B[k][l] : B[l][k]);
  return C;
}

/// P = tau F^{-T} of the uncoupled neo-Hookean law (12), straight from its formula.
inline Matrix3
neo_hookean_stress(const Matrix3 &F, const double mu, const double kappa)
{
  Matrix3 cofactor;
  for (unsigned int i = 0; i < 3; ++i)
    for (unsigned int k = 0; k < 3; ++k)
      cofactor[i][k] = F[(i + 1) % 3][(k + 1) % 3] * F[(i + 2) % 3][(k + 2) % 3] -
                       F[(i + 1) % 3][(k + 2) % 3] * F[(i + 2) % 3][(k + 1) % 3];
  const AD J      = F[0][0] * cofactor[0][0] + F[0][1] * cofactor[0][1] + F[0][2] * cofactor[0][2];
  const AD factor = mu * pow(J, -2. / 3.);
  Matrix3  tau    = product(F, F, true);
  const AD mean   = factor * (tau[0][0] + tau[1][1] + tau[2][2]) / 3.;
  Matrix3  P;
  for (unsigned int i = 0; i < 3; ++i)
    for (unsigned int k = 0; k < 3; ++k)
      tau[i][k] = factor * tau[i][k];
  for (unsigned int i = 0; i < 3; ++i)
    tau[i][i] += kappa * log(J) - mean;
  P = product(tau, cofactor, false); // F^{-T} = cofactor / J
  for (auto &row : P)
    for (auto &entry : row)
      entry /= J;
  return P;
}
