#include <stroma/grid/grid_box.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  GridBox<2>
  unequal_box()
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
  const auto grid = unequal_box();
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
  const auto             grid = unequal_box();
  const dealii::Point<2> X(2.1, -.3); // cell 2 along x, 2 along y
  EXPECT_EQ(grid.cell_number(X), 2u * 4u + 2u);
  EXPECT_LT(grid.cell_centre(X).distance({2.25, -.375}), 1e-14);
  EXPECT_LT(grid.place_in_cell(X).distance({.2, .8}), 1e-12);
}
