#pragma once

#include <stroma/grid/background_grid.h>
#include <stroma/grid/lattice_multigrid.h>
#include <stroma/solvers/operator.h>

namespace Stroma::Mpm
{
  /// The tangent as the matrices of the cells, never assembled, with geometric multigrid: of linear shape functions, where all
  /// that acts is internal forces of cells.
  template <int dim>
  class CellTangent : public Solvers::Operator
  {
  public:
    /// For the present unknowns of @p grid. @p held those held, of the ones that are relevant on this rank
    /// @param is_single of these, see LatticeLevel::hold() @param kinds of the active cells, see LatticeLevel. Collective.
    CellTangent(const BackgroundGrid<dim> &grid, const std::vector<dealii::types::global_dof_index> &held,
                const std::vector<bool> &is_single, const std::vector<unsigned int> &kinds);

    /// Makes room for the matrices, where there is none, and frees it: what is kept lasts from begin() to release().
    void
    begin()
    {
      finest.matrices.allocate();
    }
    void
    release()
    {
      finest.matrices.release();
      multigrid.release();
    }

    /// The matrix of the active cell of number @p k, which is of no kind.
    void
    set(const unsigned int k, const dealii::FullMatrix<double> &K_cell)
    {
      finest.set(k, K_cell);
    }
    /// That of all active cells of a kind.
    void
    set_kind(const unsigned int kind, const dealii::FullMatrix<double> &K_cell)
    {
      finest.set_kind(kind, K_cell);
    }

    /// To be called when all are set. Collective.
    void finish();

    /// Right-hand side of the solve: adds to @p r what the jumps of held unknowns, in their order, do to all. Collective.
    void lift(const std::vector<double> &jump, Vector &r) const;

    /// On held unknowns, the diagonal.
    void vmult(Vector &y, const Vector &x) const override;
    void diagonal(Vector &d) const override;
    void solve_decoupled(Vector &x, Vector &b) const override;
    bool
    has_multigrid() const override
    {
      return true;
    }
    void set_up_multigrid() override;
    void apply_multigrid(Vector &y, const Vector &x) const override;

    const Matrix &
    approximation() override
    {
      AssertThrow(false, dealii::ExcNotImplemented());
      static const Matrix none;
      return none;
    }

  private:
    template <typename Number>
    using Values = typename LatticeLevel<dim>::template Values<Number>;

    LatticeLevel<dim>             finest;
    mutable LatticeMultigrid<dim> multigrid;     ///< with the vectors of its solutions
    std::vector<double>           held_diagonal; ///< at held unknowns of this rank, in the order of finest.held
    mutable Values<double>        from, to;      ///< of vmult()
  };
} // namespace Stroma::Mpm
