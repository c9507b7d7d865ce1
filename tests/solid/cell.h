#pragma once

#include <stroma/solid/momentum_kernel.h>

#include <deal.II/base/tensor.h>

#include <random>
#include <vector>

/// Points of a cell with n nodes, with random gradients of the shape functions, and a random motion of the nodes.
template <int dim, unsigned int n>
struct Cell
{
  static constexpr unsigned int n_nodes = n, n_unknowns = dim * n;
  using Lanes = std::array<Stroma::Lanes<n>, dim>;

  explicit Cell(const unsigned int n_points)
    : V(n_points)
    , G(n_points)
    , u(n_unknowns)
  {
    std::mt19937                           generator(3);
    std::uniform_real_distribution<double> volume(.5, 1.5), slope(-1., 1.), motion(-.6 / n, .6 / n);
    for (unsigned int p = 0; p < n_points; ++p)
      {
        V[p] = volume(generator);
        for (auto &gradient : G[p])
          for (unsigned int d = 0; d < dim; ++d)
            gradient[d] = slope(generator);
      }
    for (double &value : u)
      value = motion(generator);
  }

  /// sum_a u_a (x) G_a at point @p p, of unknowns node by node.
  template <typename Number>
  std::array<std::array<Number, 3>, 3>
  gradient(const unsigned int p, const std::vector<Number> &unknowns) const
  {
    std::array<std::array<Number, 3>, 3> H{};
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          H[i][j] += unknowns[a * dim + i] * G[p][a][j];
    return H;
  }

  dealii::Tensor<2, 3>
  F(const unsigned int p, const std::vector<double> &unknowns) const
  {
    dealii::Tensor<2, 3> F(dealii::unit_symmetric_tensor<3>());
    const auto           H = gradient(p, unknowns);
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        F[i][j] += H[i][j];
    return F;
  }

  /// g_a = F^(-T) G_a of all nodes, as the kernels take it.
  Lanes
  spatial(const unsigned int p, const dealii::Tensor<2, 3> &F) const
  {
    const auto inverse = invert(F);
    Lanes      g{};
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          g[i][a] += inverse[j][i] * G[p][a][j];
    return g;
  }

  std::vector<double>                                      V; ///< undeformed volumes
  std::vector<std::array<dealii::Tensor<1, dim>, n_nodes>> G; ///< undeformed gradients of the shape functions
  std::vector<double>                                      u; ///< displacement of the nodes
};
