#pragma once

#include <stroma/solid/momentum_kernel.h>

#include <cmath>

namespace Stroma::Solid
{
  /**
   * Change of volume projected onto its mean over a cell (F-bar), against locking of nearly incompressible material:
   *   Fbar_p = (Jbar / J_p)^(1/dim) F_p in the dim directions of the scene,  ln Jbar = sum_p V_p ln J_p / sum_p V_p.
   * Forces and stiffness follow from the energy sum_p V_p psi(Fbar_p), so the stiffness is symmetric. With I the identity of
   * the dim directions, tau and Jc at Fbar, p = I:tau / dim and gbar_a = sum_p V_p g_a / sum_p V_p,
   *   f_a  = sum_p V_p (tau - p I) g_a + sum_p V_p p gbar_a,
   *   K_ab = sum_p V_p [ g_a . Jc' . g_b + (g_a . tau' . g_b) I ] + q_a gbar_b + gbar_a q_b + sum_p V_p M gbar_a gbar_b,
   * where, with pbar the mean of p, m = Jc:I + 2 tau and M = I:m / dim^2,
   *   tau' = tau - (p - pbar) I,  Jc' = Jc - (m I + I m) / dim + M I I + 2 (p - pbar) Isym,
   *   q_a  = sum_p V_p (m / dim - M I) g_a.
   * The terms with ' are left to MomentumKernel, the others are added here.
   */
  template <int dim, unsigned int n>
  class ProjectedDilatation
  {
  public:
    using L        = Lanes<n>;
    using Gradient = std::array<L, dim>;
    using Stress   = dealii::SymmetricTensor<2, 3>;

    /// A new cell. @p gbar mean of its points' gradients.
    void
    begin(const Gradient &gbar)
    {
      mean_gradient = gbar;
      volume = pressure_sum = M_sum = 0.;
      q                             = {};
    }

    /// p = I:tau / dim.
    static double
    mean_stress(const Stress &tau)
    {
      double sum = 0;
      for (unsigned int d = 0; d < dim; ++d)
        sum += tau[d][d];
      return sum / dim;
    }

    /// Takes in a point's stress. For all points of a cell, before any of them goes to deviator() or split().
    void
    take(const double V, const Stress &tau)
    {
      volume += V;
      pressure_sum += V * mean_stress(tau);
    }

    /// The stress for MomentumKernel::add_force.
    static Stress
    deviator(const Stress &tau)
    {
      return minus_identity(tau, mean_stress(tau));
    }

    /// Makes a point's stress and tangent those for MomentumKernel::add_stiffness.
    void split(double V, const Gradient &g, Stress &tau, dealii::SymmetricTensor<4, 3> &Jc);

    /// Adds the mean part of the force: to be given to MomentumKernel::add_nodal_force.
    L
    mean_force(const unsigned int component) const
    {
      return pressure_sum * mean_gradient[component];
    }

    /// Adds the terms with mean gradients to a cell's stiffness, unknowns ordered node by node.
    void add_stiffness(dealii::FullMatrix<double> &K) const;

  private:
    static Stress
    minus_identity(Stress tau, const double amount)
    {
      for (unsigned int d = 0; d < dim; ++d)
        tau[d][d] -= amount;
      return tau;
    }

    Gradient mean_gradient, q;
    double   volume = 0, pressure_sum = 0, M_sum = 0;
  };

  template <int dim, unsigned int n>
  inline void
  ProjectedDilatation<dim, n>::split(const double V, const Gradient &g, Stress &tau, dealii::SymmetricTensor<4, 3> &Jc)
  {
    const double p = mean_stress(tau), excess = p - pressure_sum / volume;
    Stress       m = 2. * tau, identity;
    for (unsigned int d = 0; d < dim; ++d)
      {
        identity[d][d] = 1;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = i; k < dim; ++k)
            m[i][k] += Jc[i][k][d][d];
      }
    const double M = mean_stress(m) / dim;
    for (unsigned int i = 0; i < dim; ++i)
      {
        L sum = -M * g[i];
        for (unsigned int k = 0; k < dim; ++k)
          sum += (m[i][k] / dim) * g[k];
        q[i] += V * sum;
      }
    M_sum += V * M;
    tau = minus_identity(tau, excess);
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = i; k < dim; ++k)
        for (unsigned int j = 0; j < dim; ++j)
          for (unsigned int l = j; l < dim; ++l)
            Jc[i][k][j][l] += -(m[i][k] * identity[j][l] + identity[i][k] * m[j][l]) / dim +
                              M * identity[i][k] * identity[j][l] +
                              excess * ((i == j) * (k == l) + (i == l) * (k == j));
  }

  template <int dim, unsigned int n>
  inline void
  ProjectedDilatation<dim, n>::add_stiffness(dealii::FullMatrix<double> &K) const
  {
    for (unsigned int a = 0; a < n; ++a)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int b = 0; b < n; ++b)
          for (unsigned int j = 0; j < dim; ++j)
            K(a * dim + i, b * dim + j) += q[i][a] * mean_gradient[j][b] + mean_gradient[i][a] * q[j][b] +
                                           M_sum * mean_gradient[i][a] * mean_gradient[j][b];
  }
} // namespace Stroma::Solid
