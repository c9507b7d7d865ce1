#include <stroma/grid/block_diagonal.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma
{
  namespace
  {
    /// Stiffness of a weak node over that of the strongest one of each of its cells. With .25 counts at holes are the same, but a slice at a
    /// contrast of 100 took 18 iterations for 15.
    constexpr float weak_part = .1f;
    /// Energy of a motion in a block, over that of the diagonal, up to which it is round-off of matrices in single precision.
    constexpr double round_off = 1e-6;

    /// The weak nodes of a rank, and the blocks that they make; see BlockDiagonal.
    template <int dim>
    class WeakNodes
    {
    public:
      /// @param diagonal of the sum of the cells of all ranks, ghosts too
      WeakNodes(const CellMatrices<dim> &matrices, const dealii::LinearAlgebra::distributed::Vector<float> &diagonal)
        : matrices(matrices)
      {
        find(diagonal);
        if (!weak.empty())
          group();
      }

      /// Of each block, places of its unknowns in vectors.
      std::vector<std::vector<unsigned int>> unknowns;

      /// Of each block, the sum of the cells of this rank.
      std::vector<dealii::FullMatrix<double>>
      assemble() const
      {
        std::vector<dealii::FullMatrix<double>> sums;
        for (const auto &block : unknowns)
          sums.emplace_back(block.size(), block.size());
        for_cells([&](const std::size_t, const auto &K, const auto &here) {
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

    private:
      static constexpr unsigned int n_nodes = CellMatrices<dim>::n_nodes, none = static_cast<unsigned int>(-1);

      struct Weak
      {
        unsigned int node;          ///< its number on this rank
        unsigned int block  = none; ///< the cell with the most stiffness at the node, then which block it is in
        unsigned int place  = 0;    ///< in the block
        float        K_cell = 0.f;  ///< stiffness of that cell there
      };

      void
      find(const dealii::LinearAlgebra::distributed::Vector<float> &diagonal)
      {
        const auto stiffness = [&](const unsigned int node) {
          return *std::max_element(diagonal.begin() + node * dim, diagonal.begin() + (node + 1) * dim);
        };
        const std::size_t  n_own = diagonal.locally_owned_size() / dim;
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

      void
      group()
      {
        for_cells([&](const std::size_t k, const auto &K, const auto &here) {
          for (unsigned int a = 0; a < n_nodes; ++a)
            if (here[a] != none)
              for (unsigned int i = a * dim; i < (a + 1) * dim; ++i)
                if (Weak &node = weak[here[a]]; node.block == none || K(i, i) > node.K_cell)
                  {
                    node.block  = k;
                    node.K_cell = K(i, i);
                  }
        });
        std::vector<unsigned int> of_cell(matrices.n_cells(), none);
        for (Weak &node : weak)
          {
            unsigned int &block = of_cell[node.block];
            if (block == none)
              {
                block = unknowns.size();
                unknowns.emplace_back();
              }
            node.block = block;
            node.place = unknowns[block].size();
            for (unsigned int i = 0; i < dim; ++i)
              unknowns[block].push_back(node.node * dim + i);
          }
      }

      /// Calls visit(cell, its matrix, which weak node each of its nodes is, or none) for the cells that have any.
      template <typename Visit>
      void
      for_cells(const Visit &visit) const
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

      const CellMatrices<dim>  &matrices;
      std::vector<Weak>         weak;
      std::vector<unsigned int> weak_of; ///< by node of this rank: which weak one it is, or none; empty: there are none
    };
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
    const WeakNodes<dim> weak(level.matrices, diagonal);
    if (weak.unknowns.empty())
      return;
    const auto sums = weak.assemble();
    for (std::size_t k = 0; k < sums.size(); ++k)
      {
        blocks.emplace_back();
        blocks.back().unknowns = weak.unknowns[k];
        invert(blocks.back(), sums[k], diagonal);
      }
  }

  /// Scaled to a diagonal of 1. A motion that costs next to no energy is divided by 1: its stiffness is round-off.
  template <int dim>
  void
  BlockDiagonal<dim>::invert(Block &block, const dealii::FullMatrix<double> &sum, const Values &diagonal) const
  {
    const unsigned int n     = block.unknowns.size();
    const auto         scale = [&](const unsigned int i) { // 0 where an unknown is held
      const unsigned int place = block.unknowns[i];
      return inverse.local_element(place) > 0.f ? 1. / std::sqrt(diagonal.local_element(place)) : 0.;
    };
    Eigen::MatrixXd B(n, n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        B(i, j) = i == j ? 1. : scale(i) * sum(i, j) * scale(j);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(B);
    Eigen::VectorXd                                      weights = modes.eigenvalues();
    for (double &weight : weights)
      weight = weight > round_off ? 1. / weight : 1.;
    B = modes.eigenvectors() * weights.asDiagonal() * modes.eigenvectors().transpose();
    block.inverse.reinit(n, n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        block.inverse(i, j) = scale(i) * B(i, j) * scale(j);
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
