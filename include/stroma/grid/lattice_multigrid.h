#pragma once

#include <stroma/grid/block_diagonal.h>

#include <deal.II/lac/diagonal_matrix.h>
#include <deal.II/lac/lapack_full_matrix.h>
#include <deal.II/lac/precondition.h>

#include <memory>
#include <variant>

namespace Stroma
{
  /**
   * Geometric multigrid of the unassembled stiffness of a grid, in single precision: coarse cells are pairs along the axes on
   * which cells are short (at most 1.5 times the shortest side), so that they become cubes, with matrices P^T K P of linear
   * functions (Galerkin); Chebyshev smoothing of degree 3 by the diagonal, of weak nodes by blocks (BlockDiagonal);
   * W-cycles; the coarsest grid by a dense factor on each rank. A coarse unknown that moves a held one is held. Sizes need not be even: a last cell without a sibling
   * is its own parent. Where cells are missing, a coarse node is split by what connects below it (NodeCopies); there, and where
   * cells differ in stiffness, functions are bent ones (BentWeights).
   *
   * A rank coarsens its own cells: a coarse cell of several ranks has a part of its matrix on each.
   */
  template <int dim>
  class LatticeMultigrid
  {
  public:
    using Values = dealii::LinearAlgebra::distributed::Vector<float>;

    /// Grids beside @p finest, of cells of @p box, whose held unknowns are known; it must outlive this. Collective.
    LatticeMultigrid(LatticeLevel<dim> &finest, const GridBox<dim> &box, MPI_Comm comm);

    /// Cells of all coarser grids together, of a grid whose cells all carry unknowns.
    static double n_coarser_cells(GridBox<dim> box);

    /// Coarse matrices and smoothers for the present matrices of the finest grid. Throws if the coarsest is singular, on all
    /// ranks. Collective.
    void set_up();

    /// Frees the coarse matrices until the next set_up().
    void release();

    /// solution() = about K^-1 right_side(), symmetric positive definite. Collective.
    void apply();

    /// To be set before apply().
    Values &
    right_side()
    {
      return levels.front()->b;
    }
    const Values &
    solution() const
    {
      return levels.front()->x;
    }

  private:
    template <typename Diagonal>
    using Chebyshev = dealii::PreconditionChebyshev<LatticeLevel<dim>, Values, Diagonal>;

    /// A grid with what it needs to be smoothed.
    struct Level
    {
      LatticeLevel<dim>                   *grid;
      std::unique_ptr<ShapeFunctions<dim>> shape; ///< of coarse ones
      std::unique_ptr<NodeLattice<dim>>    nodes;
      std::unique_ptr<LatticeLevel<dim>>   own_grid;
      std::variant<Chebyshev<dealii::DiagonalMatrix<Values>>, Chebyshev<BlockDiagonal<dim>>>
                     smoother; ///< the second, slower one where there are weak nodes
      mutable Values x, b, r;
    };

    template <typename Diagonal>
    static void set_up_smoother(Level &level, const std::shared_ptr<Diagonal> &inverse);
    static void join_cells(GridBox<dim> &box);
    void        add_coarser(GridBox<dim> &box);
    static void choose_smoother(Level &level);
    void        set_up_coarsest();
    void        solve_coarsest() const;
    void        cycle(unsigned int l, bool from_zero) const;

    MPI_Comm                            comm;
    bool                                is_full; ///< whether all cells of the box carry unknowns
    std::vector<std::unique_ptr<Level>> levels;  ///< from the finest
    dealii::LAPACKFullMatrix<double>    coarsest;
  };
} // namespace Stroma
