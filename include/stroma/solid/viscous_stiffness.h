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
    const dealii::Tensor<2, 3> sigma = Materials::viscous_stress(medium, velocity_gradient);
    for (unsigned int b = 0; b < n; ++b)
      for (unsigned int e = 0; e < dim; ++e)
        {
          dealii::Tensor<2, 3> l;
          for (unsigned int k = 0; k < dim; ++k)
            l[e][k] = g[k][b];
          const auto rate = l[e][e] * sigma + Materials::viscous_stress(medium, v_factor * l - velocity_gradient * l) -
                            sigma * transpose(l);
          auto &forces = column[b * dim + e];
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              forces[i] += (VJ * rate[i][k]) * g[k];
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
