#pragma once

#include <stroma/solid/momentum_kernel.h>

#include <deal.II/base/tensor.h>

#include <random>
#include <vector>

/// Points at random places of a linear cell of unequal edges, and a random motion of its nodes.
template <int dim>
struct Cell
{
  static constexpr unsigned int n_nodes = 1u << dim, n_unknowns = dim << dim;
  using Lanes = std::array<Stroma::Solid::Lanes<dim>, dim>;

  explicit Cell(const unsigned int n_points)
    : V(n_points)
    , G(n_points)
    , u(n_unknowns)
  {
    std::mt19937                           generator(3);
    std::uniform_real_distribution<double> place(0., 1.), motion(-.15, .15);
    for (unsigned int p = 0; p < n_points; ++p)
      {
        V[p] = .5 + place(generator);
        std::array<double, dim> xi;
        for (double &x : xi)
          x = place(generator);
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int d = 0; d < dim; ++d)
            {
              G[p][a][d] = (a >> d & 1 ? 1. : -1.) / (1. + .3 * d);
              for (unsigned int e = 0; e < dim; ++e)
                if (e != d)
                  G[p][a][d] *= a >> e & 1 ? xi[e] : 1. - xi[e];
            }
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
