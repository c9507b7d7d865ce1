#pragma once

#include <stroma/base/lanes.h>

#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/lac/full_matrix.h>

#include <array>

namespace Stroma::Solid
{
  /**
   * Momentum balance over the points of one cell with n nodes: internal force (3) and the material and geometric stiffness
   * (5), (6) of Guilkey 2006 in their spatial form,
   *   f_a   = sum_p V_p tau_p g_a,
   *   K_ab  = sum_p V_p [ g_a . Jc_p . g_b + (g_a . tau_p . g_b) I ],
   * with V the initial volume, tau the Kirchhoff stress and g_a the gradient of the shape function of node a at the
   * point. All nodes of the cell are handled at once in vector lanes.
   */
  template <int dim, unsigned int n>
  class MomentumKernel
  {
  public:
    using L                             = Lanes<n>;
    static constexpr unsigned int chunk = 8; ///< points whose intermediate products stay in the first cache

    /// Gradients of all shape functions at a point, by direction.
    using Gradient = std::array<L, dim>;

    void clear();

    /// Adds V tau g to the force.
    void add_force(double V, const dealii::SymmetricTensor<2, 3> &tau, const Gradient &g);

    /// Adds a point to the stiffness. Call finish_stiffness() after the last one.
    void add_stiffness(double V, const dealii::SymmetricTensor<2, 3> &tau, const dealii::SymmetricTensor<4, 3> &Jc,
                       const Gradient &g);

    /// Adds to component @p c of the force.
    void
    add_nodal_force(double amount, unsigned int c, const L &N)
    {
      force[c] += amount * N;
    }

    void finish_stiffness();

    /// Force on node a, component c.
    double
    force_at(const unsigned int a, const unsigned int c) const
    {
      return force[c][a];
    }

    /// Copies the stiffness, unknowns ordered node by node, into @p K (n*dim square).
    void copy_stiffness(dealii::FullMatrix<double> &K) const;

  private:
    static constexpr unsigned int n_symmetric = dim * (dim + 1) / 2;

    /// Position of (i, k) in deal.II's order of symmetric components: in the 3x3 tensors, and in the dim x dim part.
    static constexpr unsigned int
    voigt(const unsigned int i, const unsigned int k)
    {
      constexpr unsigned int order[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
      return order[i][k];
    }
    static constexpr unsigned int
    pair(const unsigned int i, const unsigned int k)
    {
      return dim == 3 ? voigt(i, k) : (i == k ? i : 2);
    }

    void flush();

    std::array<L, dim> force;

    // Chunk of points waiting for the second product.
    unsigned int                                                   waiting = 0;
    std::array<Gradient, chunk>                                    gradient;
    std::array<std::array<std::array<L, dim>, n_symmetric>, chunk> stress_rate; // [ik][j]: V Jc_ikjl g_l
    std::array<Gradient, chunk>                                    traction;    // [k]: V tau_kl g_l

    // [i <= j][a] lanes over b, and the isotropic geometric part [a] lanes over b.
    std::array<std::array<L, n>, n_symmetric> stiffness;
    std::array<L, n>                          geometric;
  };

  template <int dim, unsigned int n>
  inline void
  MomentumKernel<dim, n>::clear()
  {
    waiting   = 0;
    force     = {};
    stiffness = {};
    geometric = {};
  }

  template <int dim, unsigned int n>
  inline void
  MomentumKernel<dim, n>::add_force(const double V, const dealii::SymmetricTensor<2, 3> &tau, const Gradient &g)
  {
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        force[i] += (V * tau.access_raw_entry(voigt(i, k))) * g[k];
  }

  template <int dim, unsigned int n>
  inline void
  MomentumKernel<dim, n>::add_stiffness(const double V, const dealii::SymmetricTensor<2, 3> &tau,
                                        const dealii::SymmetricTensor<4, 3> &Jc, const Gradient &g)
  {
    gradient[waiting] = g;
    for (unsigned int k = 0; k < dim; ++k)
      {
        L sum{};
        for (unsigned int l = 0; l < dim; ++l)
          sum += (V * tau.access_raw_entry(voigt(k, l))) * g[l];
        traction[waiting][k] = sum;
      }
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = i; k < dim; ++k)
        for (unsigned int j = 0; j < dim; ++j)
          {
            L sum{};
            for (unsigned int l = 0; l < dim; ++l)
              sum += (V * Jc.access_raw_entry(6 * voigt(i, k) + voigt(j, l))) * g[l];
            stress_rate[waiting][pair(i, k)][j] = sum;
          }
    if (++waiting == chunk)
      flush();
  }

  template <int dim, unsigned int n>
  inline void
  MomentumKernel<dim, n>::flush()
  {
    for (unsigned int a = 0; a < n; ++a)
      {
        L s = geometric[a];
        for (unsigned int p = 0; p < waiting; ++p)
          for (unsigned int k = 0; k < dim; ++k)
            s += gradient[p][k][a] * traction[p][k];
        geometric[a] = s;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = i; j < dim; ++j)
            {
              L t = stiffness[pair(i, j)][a];
              for (unsigned int p = 0; p < waiting; ++p)
                for (unsigned int k = 0; k < dim; ++k)
                  t += gradient[p][k][a] * stress_rate[p][pair(i, k)][j];
              stiffness[pair(i, j)][a] = t;
            }
      }
    waiting = 0;
  }

  template <int dim, unsigned int n>
  inline void
  MomentumKernel<dim, n>::finish_stiffness()
  {
    flush();
  }

  template <int dim, unsigned int n>
  inline void
  MomentumKernel<dim, n>::copy_stiffness(dealii::FullMatrix<double> &K) const
  {
    for (unsigned int a = 0; a < n; ++a)
      for (unsigned int b = 0; b < n; ++b)
        for (unsigned int i = 0; i < dim; ++i)
          {
            K(a * dim + i, b * dim + i) = stiffness[pair(i, i)][a][b] + geometric[a][b];
            for (unsigned int j = i + 1; j < dim; ++j)
              {
                K(a * dim + i, b * dim + j) = stiffness[pair(i, j)][a][b];
                K(b * dim + j, a * dim + i) = stiffness[pair(i, j)][a][b];
              }
          }
  }
} // namespace Stroma::Solid
