#include <stroma/grid/background_grid.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  GridBox<2>
  box()
  {
    GridBox<2> box;
    box.lower     = {1., -1.};
    box.cell_size = dealii::Tensor<1, 2>({.5, .25});
    box.n_cells   = {{4, 8}};
    return box;
  }
} // namespace

TEST(GridBox, APointOnAFaceBelongsToTheCellAboveIt)
{
  const auto grid = box();
  EXPECT_EQ(grid.cell_index(1., 0), 0);
  EXPECT_EQ(grid.cell_index(1.49, 0), 0);
  EXPECT_EQ(grid.cell_index(1.5, 0), 1);
  EXPECT_EQ(grid.cell_index(1.5 - 1e-12, 0), 1); // round-off
  EXPECT_EQ(grid.cell_index(3., 0), 3);          // the last cell owns its upper face
  EXPECT_EQ(grid.cell_index(3.1, 0), 4);
  EXPECT_EQ(grid.cell_index(.9, 0), -1);
  EXPECT_EQ(grid.upper(), dealii::Point<2>(3., 1.));
}

TEST(GridBox, CellsAreNumberedAlongXFirst)
{
  const auto             grid = box();
  const dealii::Point<2> X(2.1, -.3); // cell 2 along x, 2 along y
  EXPECT_EQ(grid.cell_number(X), 2u * 4u + 2u);
  EXPECT_LT(grid.cell_centre(X).distance({2.25, -.375}), 1e-14);
  EXPECT_LT(grid.place_in_cell(X).distance({.2, .8}), 1e-12);
}

TEST(BackgroundGrid, MpiOnlyCellsWithMaterialHaveUnknowns)
{
  BackgroundGrid<2> grid(box(), MPI_COMM_WORLD);
  EXPECT_EQ(grid.triangulation.n_global_active_cells(), 32u);
  const auto mark = [&](const auto &holds) {
    std::vector<bool> material(grid.triangulation.n_active_cells(), false);
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      material[cell->active_cell_index()] = cell->is_locally_owned() && holds(cell->center());
    grid.distribute_unknowns(material);
  };
  mark([](const auto &) { return true; });
  EXPECT_EQ(grid.n_active_cells(), 32u);
  EXPECT_EQ(grid.dofs.n_dofs(), 2u * 5u * 9u);
  mark([](const auto &X) { return X[0] < 2. && X[1] < -.5; }); // 2 x 2 cells
  EXPECT_EQ(grid.n_active_cells(), 4u);
  EXPECT_EQ(grid.dofs.n_dofs(), 2u * 9u);
  EXPECT_EQ(dealii::Utilities::MPI::sum(grid.owned.n_elements(), MPI_COMM_WORLD), 18u);
  for (const auto &cell : grid.dofs.active_cell_iterators())
    if (!cell->is_artificial())
      {
        EXPECT_EQ(grid.is_active(cell), cell->center()[0] < 2. && cell->center()[1] < -.5);
      }
}
