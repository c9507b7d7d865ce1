#include <stroma/grid/block_diagonal.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma
{
  namespace
  {
    /// Stiffness of a weak node over that of the strongest one of each of its cells. Between .1 and .6 counts of iterations stay the same.
    constexpr float weak_part = .1f;
    /// Energy of a motion in a block, over that of the diagonal, up to which it is round-off of matrices in single precision.
    constexpr double round_off = 1e-6;
  } // namespace

  template <int dim>
  BlockDiagonal<dim>::BlockDiagonal(const LatticeLevel<dim> &level)
    : inverse(level.template new_vector<float>())
  {
    auto diagonal = inverse;
    level.find_diagonal(diagonal);
    diagonal.update_ghost_values();
    for (unsigned int i = 0; i < inverse.locally_owned_size(); ++i)
      inverse.local_element(i) = diagonal.local_element(i) > 0.f ? 1.f / diagonal.local_element(i) : 0.f;
    level.set_held_to_zero(inverse);
    find_weak(level, diagonal);
    if (weak.empty())
      return;
    make_blocks(level);
    invert(assemble(level), diagonal);
  }

  template <int dim>
  void
  BlockDiagonal<dim>::find_weak(const LatticeLevel<dim> &level, const Values &diagonal)
  {
    const CellMatrices<dim> &matrices  = level.matrices;
    const auto               stiffness = [&](const unsigned int node) {
      return *std::max_element(diagonal.begin() + node * dim, diagonal.begin() + (node + 1) * dim);
    };
    const std::size_t  n_own = inverse.locally_owned_size() / dim;
    std::vector<float> least(n_own, std::numeric_limits<float>::max()); // of the strongest nodes of each cell
    for (std::size_t k = 0; k < matrices.n_cells(); ++k)
      {
        float strongest = 0.f;
        for (unsigned int a = 0; a < n_nodes; ++a)
          strongest = std::max(strongest, stiffness(matrices.first(k, a) / dim));
        for (unsigned int a = 0; a < n_nodes; ++a)
          if (const std::size_t node = matrices.first(k, a) / dim; node < n_own)
            least[node] = std::min(least[node], strongest);
      }
    for (unsigned int node = 0; node < n_own; ++node)
      if (stiffness(node) < weak_part * least[node])
        {
          weak_of.resize(n_own, none);
          weak_of[node] = weak.size();
          weak.push_back({node});
        }
  }

  /// Calls visit(cell, its matrix, which weak node each of its nodes is, or none) for the cells that have any.
  template <int dim>
  template <typename Visit>
  void
  BlockDiagonal<dim>::for_weak_cells(const CellMatrices<dim> &matrices, const Visit &visit) const
  {
    dealii::FullMatrix<double> K;
    for (std::size_t k = 0; k < matrices.n_cells(); ++k)
      {
        std::array<unsigned int, n_nodes> here;
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            const std::size_t node = matrices.first(k, a) / dim;
            here[a]                = node < weak_of.size() ? weak_of[node] : none;
          }
        if (std::all_of(here.begin(), here.end(), [](const unsigned int w) { return w == none; }))
          continue;
        matrices.get(k, K);
        visit(k, K, here);
      }
  }

  template <int dim>
  void
  BlockDiagonal<dim>::make_blocks(const LatticeLevel<dim> &level)
  {
    for_weak_cells(level.matrices, [&](const std::size_t k, const auto &K, const auto &here) {
      for (unsigned int a = 0; a < n_nodes; ++a)
        if (here[a] != none)
          for (unsigned int i = a * dim; i < (a + 1) * dim; ++i)
            if (Weak &node = weak[here[a]]; node.block == none || K(i, i) > node.stiffness)
              {
                node.block     = k;
                node.stiffness = K(i, i);
              }
    });
    std::vector<unsigned int> of_cell(level.matrices.n_cells(), none);
    for (Weak &node : weak)
      {
        unsigned int &block = of_cell[node.block];
        if (block == none)
          {
            block = blocks.size();
            blocks.emplace_back();
          }
        auto &unknowns = blocks[block].unknowns;
        node.block     = block;
        node.place     = unknowns.size();
        for (unsigned int i = 0; i < dim; ++i)
          unknowns.push_back(node.node * dim + i);
      }
  }

  /// Sums of the cells of this rank.
  template <int dim>
  std::vector<dealii::FullMatrix<double>>
  BlockDiagonal<dim>::assemble(const LatticeLevel<dim> &level) const
  {
    std::vector<dealii::FullMatrix<double>> sums;
    for (const Block &block : blocks)
      sums.emplace_back(block.unknowns.size(), block.unknowns.size());
    for_weak_cells(level.matrices, [&](const std::size_t, const auto &K, const auto &here) {
      for (unsigned int a = 0; a < n_nodes; ++a)
        for (unsigned int b = 0; b < n_nodes; ++b)
          if (here[a] != none && here[b] != none && weak[here[a]].block == weak[here[b]].block)
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int j = 0; j < dim; ++j)
                sums[weak[here[a]].block](weak[here[a]].place + i, weak[here[b]].place + j) += K(a * dim + i,
                                                                                                 b * dim + j);
    });
    return sums;
  }

  /// Of blocks scaled to a diagonal of 1. A motion that costs next to no energy is divided by 1: its stiffness is round-off.
  template <int dim>
  void
  BlockDiagonal<dim>::invert(const std::vector<dealii::FullMatrix<double>> &sums, const Values &diagonal)
  {
    for (std::size_t k = 0; k < blocks.size(); ++k)
      {
        const auto        &unknowns = blocks[k].unknowns;
        const unsigned int n        = unknowns.size();
        const auto         scale    = [&](const unsigned int i) { // 0 where an unknown is held
          return inverse.local_element(unknowns[i]) > 0.f ? 1. / std::sqrt(diagonal.local_element(unknowns[i])) : 0.;
        };
        Eigen::MatrixXd B(n, n);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            B(i, j) = i == j ? 1. : scale(i) * sums[k](i, j) * scale(j);
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(B);
        Eigen::VectorXd                                      weights = modes.eigenvalues();
        for (double &weight : weights)
          weight = weight > round_off ? 1. / weight : 1.;
        B = modes.eigenvectors() * weights.asDiagonal() * modes.eigenvectors().transpose();
        blocks[k].inverse.reinit(n, n);
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            blocks[k].inverse(i, j) = scale(i) * B(i, j) * scale(j);
      }
  }

  template <int dim>
  void
  BlockDiagonal<dim>::vmult(Values &y, const Values &x) const
  {
    const unsigned int n_own = inverse.locally_owned_size();
    for (unsigned int i = 0; i < n_own; ++i)
      y.local_element(i) = inverse.local_element(i) * x.local_element(i);
    for (const Block &block : blocks)
      for (unsigned int i = 0; i < block.unknowns.size(); ++i)
        {
          double sum = 0.;
          for (unsigned int j = 0; j < block.unknowns.size(); ++j)
            sum += block.inverse(i, j) * x.local_element(block.unknowns[j]);
          y.local_element(block.unknowns[i]) = static_cast<float>(sum);
        }
  }

  template class BlockDiagonal<2>;
  template class BlockDiagonal<3>;
} // namespace Stroma
