#include <stroma/grid/background_grid.h>
#include <stroma/grid/cell_scatter.h>

#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  using dealii::types::global_dof_index;

  /// A grid all of whose cells hold material, and matrices on it.
  template <int dim>
  struct Assembly
  {
    /// @param shape which of the shape functions
    explicit Assembly(const unsigned int shape)
      : grid(cube(), shape_functions<dim>()[shape], MPI_COMM_WORLD)
      , n_nodes(grid.shape->n_nodes())
    {
      grid.distribute_unknowns(std::vector<bool>(grid.triangulation.n_active_cells(), true));
    }

    static GridBox<dim>
    cube()
    {
      GridBox<dim> box;
      for (unsigned int d = 0; d < dim; ++d)
        {
          box.cell_size[d] = 1.;
          box.n_cells[d]   = 4;
        }
      return box;
    }

    /// Unknowns of a cell, node by node.
    std::vector<global_dof_index>
    unknowns(const ActiveCell<dim> &active) const
    {
      std::vector<global_dof_index> all;
      for (unsigned int a = 0; a < n_nodes; ++a)
        for (unsigned int c = 0; c < dim; ++c)
          all.push_back(grid.nodes.relevant.nth_index_in_set(active.node[a]) + c);
      return all;
    }

    /// @param with_cells whether rows have any columns but their diagonal
    void
    make(Matrix &K, const bool with_cells = true) const
    {
      dealii::TrilinosWrappers::SparsityPattern pattern(grid.nodes.owned, grid.nodes.owned, grid.nodes.relevant,
                                                        MPI_COMM_WORLD);
      for (const auto i : grid.nodes.owned)
        pattern.add(i, i);
      for (const auto &active : grid.active_cells())
        if (const auto all = unknowns(active); with_cells)
          for (const auto i : all)
            pattern.add_entries(i, all.begin(), all.end());
      pattern.compress();
      K.reinit(pattern);
    }

    /// Calls visit(cell, K_cell) for each owned cell, with numbers that are those of no other cell.
    template <typename Visit>
    void
    for_each_cell(const Visit &visit) const
    {
      dealii::FullMatrix<double> K_cell(dim * n_nodes);
      for (const auto &active : grid.active_cells())
        {
          for (unsigned int i = 0; i < K_cell.m(); ++i)
            for (unsigned int j = 0; j < K_cell.n(); ++j)
              K_cell(i, j) = std::sin(active.cell->center().norm() + 3. * i + 7. * j);
          visit(active, K_cell);
        }
    }

    BackgroundGrid<dim> grid;
    unsigned int        n_nodes;
  };

  /// Scattered cells, the others the long way, are the matrix all of whose cells went the long way.
  template <int dim>
  void
  check(const unsigned int shape)
  {
    const Assembly<dim> a(shape);
    Matrix              K, witness;
    a.make(K);
    a.make(witness);
    CellScatter<dim> scatter(K, a.grid.nodes.relevant, a.n_nodes);
    unsigned int     n_scattered = 0;
    a.for_each_cell([&](const auto &active, const auto &K_cell) {
      if (scatter.add(active.node, K_cell))
        ++n_scattered;
      else
        K.add(a.unknowns(active), K_cell);
      witness.add(a.unknowns(active), K_cell);
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
  for (const unsigned int shape : {0, 1})
    {
      check<2>(shape);
      check<3>(shape);
    }
}

TEST(CellScatter, MpiChangesNothingWhereThePatternHasNoPlace)
{
  const Assembly<2> a(0);
  Matrix            K;
  a.make(K, false);
  CellScatter<2> scatter(K, a.grid.nodes.relevant, a.n_nodes);
  a.for_each_cell([&](const auto &active, const auto &K_cell) { EXPECT_FALSE(scatter.add(active.node, K_cell)); });
  EXPECT_EQ(K.frobenius_norm(), 0.);
}
