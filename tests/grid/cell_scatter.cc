#include <stroma/grid/background_grid.h>
#include <stroma/grid/cell_scatter.h>

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  using dealii::types::global_dof_index;

  /// A grid all of whose cells hold material, and a matrix on it.
  template <int dim>
  struct Assembly
  {
    Assembly()
      : grid(box(), MPI_COMM_WORLD)
      , dofs(dim << dim)
    {
      grid.distribute_unknowns(std::vector<bool>(grid.triangulation.n_active_cells(), true));
    }

    static GridBox<dim>
    box()
    {
      GridBox<dim> box;
      for (unsigned int d = 0; d < dim; ++d)
        {
          box.cell_size[d] = 1.;
          box.n_cells[d]   = 4;
        }
      return box;
    }

    /// @param with_pattern whether rows have any columns but their diagonal
    void
    make(Matrix &K, const bool with_pattern = true) const
    {
      dealii::TrilinosWrappers::SparsityPattern pattern(grid.owned, grid.owned, grid.relevant, MPI_COMM_WORLD);
      if (with_pattern)
        dealii::DoFTools::make_sparsity_pattern(grid.dofs, pattern, dealii::AffineConstraints<double>(), false,
                                                dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD));
      else
        for (const auto i : grid.owned)
          pattern.add(i, i);
      pattern.compress();
      K.reinit(pattern);
    }

    /// Calls visit(unknowns, nodes, K_cell) for each owned cell, with numbers that are those of no other cell.
    template <typename Visit>
    void
    for_each_cell(const Visit &visit)
    {
      dealii::FullMatrix<double> K_cell(dim << dim);
      for (const auto &cell : grid.dofs.active_cell_iterators())
        if (cell->is_locally_owned())
          {
            cell->get_dof_indices(dofs);
            std::array<int, (1u << dim)> node;
            for (unsigned int a = 0; a < node.size(); ++a)
              node[a] = grid.relevant.index_within_set(dofs[a * dim]);
            for (unsigned int i = 0; i < dofs.size(); ++i)
              for (unsigned int j = 0; j < dofs.size(); ++j)
                K_cell(i, j) = std::sin(cell->center().norm() + 3. * i + 7. * j);
            visit(dofs, node, K_cell);
          }
    }

    BackgroundGrid<dim>           grid;
    std::vector<global_dof_index> dofs;
  };

  /// Scattered cells, the others the long way, are the matrix all of whose cells went the long way.
  template <int dim>
  void
  check()
  {
    Assembly<dim> a;
    Matrix        K, witness;
    a.make(K);
    a.make(witness);
    CellScatter<dim> scatter(K, a.grid.relevant);
    unsigned int     n_scattered = 0;
    a.for_each_cell([&](const auto &dofs, const auto &node, const auto &K_cell) {
      if (scatter.add(node, K_cell))
        ++n_scattered;
      else
        K.add(dofs, K_cell);
      witness.add(dofs, K_cell);
    });
    K.compress(dealii::VectorOperation::add);
    witness.compress(dealii::VectorOperation::add);
    EXPECT_GT(dealii::Utilities::MPI::sum(n_scattered, MPI_COMM_WORLD), 0u);
    K.add(-1., witness);
    EXPECT_LT(K.frobenius_norm(), 1e-13 * witness.frobenius_norm());
  }
} // namespace

TEST(CellScatter, MpiGivesTheMatrixOfTheLongWay)
{
  check<2>();
  check<3>();
}

TEST(CellScatter, MpiChangesNothingWhereThePatternHasNoPlace)
{
  Assembly<2> a;
  Matrix      K;
  a.make(K, false);
  CellScatter<2> scatter(K, a.grid.relevant);
  a.for_each_cell([&](const auto &, const auto &node, const auto &K_cell) { EXPECT_FALSE(scatter.add(node, K_cell)); });
  EXPECT_EQ(K.frobenius_norm(), 0.);
}
