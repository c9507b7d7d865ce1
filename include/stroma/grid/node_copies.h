#pragma once

#include <stroma/grid/cell_matrices.h>

#include <deal.II/base/partitioner.h>

#include <unordered_map>

namespace Stroma
{
  /**
   * Copies of the nodes of the next coarser grid: one for each part of the body within a node's linear function that cells of
   * the finer grid connect there. So no coarse function moves the two banks of a thin hole together.
   *
   * A piece is what a node's function moves of the finer grid's nodes, as far as cells connect it: union-find of pairs
   * (finer node, coarse node that moves it). Pieces of several ranks are joined where they share a node of the finer grid.
   */
  template <int dim>
  class NodeCopies
  {
  public:
    using Index = std::array<unsigned int, dim>;

    /// @param cells of the finer grid, whose nodes @p partition knows by their unknowns @param places of these in their parents
    /// @param parents indices of these, cell by cell @param next cells of the coarse grid along each axis. Collective.
    NodeCopies(const CellMatrices<dim> &cells, const std::vector<PlaceInParent<dim>> &places,
               const std::vector<Index> &parents, const std::array<unsigned int, dim> &next,
               const dealii::Utilities::MPI::Partitioner &partition);

    /// Which copy of its parent's node @p p moves cell @p k of the finer grid, counted from 0.
    std::uint32_t copy(std::size_t k, unsigned int p) const;

  private:
    static constexpr unsigned int n_nodes = CellMatrices<dim>::n_nodes;

    using Pair = std::uint32_t; ///< finer node of this rank * n_nodes + which of the coarse ones that move it

    /// A part of this rank.
    struct Piece
    {
      std::uint64_t              node; ///< on the lattice of the coarse grid
      Pair                       root;
      std::vector<std::uint64_t> border; ///< its nodes of the finer grid that ranks share, by their unknowns
    };

    Pair               pair(std::size_t k, unsigned int a, unsigned int p) const;
    Pair               root_of(Pair pair) const;
    void               connect();
    std::vector<Piece> find_pieces(const std::vector<Index> &parents, const std::array<unsigned int, dim> &next,
                                   const dealii::Utilities::MPI::Partitioner &partition) const;
    void               number(const std::vector<Piece> &pieces, std::uint64_t n_lattice, MPI_Comm comm);

    const CellMatrices<dim>                &cells;
    const std::vector<PlaceInParent<dim>>  &places;
    mutable std::vector<Pair>               above;   ///< union-find: of each pair one nearer to its root
    std::unordered_map<Pair, std::uint32_t> copy_of; ///< of roots; absent: 0
  };
} // namespace Stroma
