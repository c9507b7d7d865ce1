#pragma once

#include <stroma/base/lanes.h>
#include <stroma/materials/viscosity.h>

#include <deal.II/lac/full_matrix.h>

#include <array>

namespace Stroma::Solid
{
  /**
   * Stiffness of the viscous forces f_a = sum_p V J sigma_v(L) g_a over the points of one cell with n nodes, where the velocity
   * gradient L = sum_b v_b (x) g_b follows the displacement by dv/du = v_factor. Along l = e (x) g_b, the change of node b
   * in direction e,
   *   dL = v_factor l - L l,   dJ = J tr l,   dg_a = -l^T g_a,
   *   df_a = sum_p V J [ tr l sigma_v(L) + sigma_v(dL) - sigma_v(L) l^T ] g_a.
   * dL = w (x) g_b with w = (v_factor I - L) e, so that with the moduli of viscous_stress() and s_a = sigma_v(L) g_a
   *   df_a = sum_p V J [ (g_b . e) s_a + on_L (g_b . g_a) w + on_transposed (w . g_a) g_b + on_trace (w . g_b) g_a
   *                      - (g_a . e) s_b ].
   * Not symmetric.
   */
  template <int dim, unsigned int n>
  class ViscousStiffness
  {
  public:
    using L                                 = Lanes<n>;
    using Gradient                          = std::array<L, dim>;
    static constexpr unsigned int n_columns = dim * n;

    void
    clear()
    {
      column = {};
    }

    /// Adds a point. @p VJ its volume now [m^3], @p velocity_gradient [1/s], @p v_factor [1/s]
    void add(double VJ, const Materials::Medium &medium, const dealii::Tensor<2, 3> &velocity_gradient, double v_factor,
             const Gradient &g);

    /// Adds the stiffness, unknowns ordered node by node, to @p K.
    void add_to(dealii::FullMatrix<double> &K) const;

  private:
    std::array<std::array<L, dim>, n_columns> column; ///< [unknown][component] lanes over nodes
  };

  template <int dim, unsigned int n>
  inline void
  ViscousStiffness<dim, n>::add(const double VJ, const Materials::Medium &medium,
                                const dealii::Tensor<2, 3> &velocity_gradient, const double v_factor, const Gradient &g)
  {
    const auto moduli = Materials::viscous_moduli(medium);
    const auto sigma  = VJ * Materials::viscous_stress(medium, velocity_gradient);
    Gradient   s{};   // [i] (sigma g_a)_i
    Gradient   w_g{}; // [e] w . g_a
    double     w[dim][dim];
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        {
          w[k][i] = VJ * ((i == k ? v_factor : 0.) - velocity_gradient[i][k]);
          s[i] += sigma[i][k] * g[k];
          w_g[k] += w[k][i] * g[i];
        }
    for (unsigned int b = 0; b < n; ++b)
      {
        L g_g{}; // g_b . g_a
        for (unsigned int k = 0; k < dim; ++k)
          g_g += g[k][b] * g[k];
        for (unsigned int e = 0; e < dim; ++e)
          for (unsigned int i = 0; i < dim; ++i)
            {
              L &force = column[b * dim + e][i];
              force += g[e][b] * s[i];
              force += (moduli.on_L * w[e][i]) * g_g;
              force += (moduli.on_transposed * g[i][b]) * w_g[e];
              force += (moduli.on_trace * w_g[e][b]) * g[i];
              force += -s[i][b] * g[e];
            }
      }
  }

  template <int dim, unsigned int n>
  inline void
  ViscousStiffness<dim, n>::add_to(dealii::FullMatrix<double> &K) const
  {
    for (unsigned int j = 0; j < n_columns; ++j)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int a = 0; a < n; ++a)
          K(a * dim + i, j) += column[j][i][a];
  }
} // namespace Stroma::Solid
