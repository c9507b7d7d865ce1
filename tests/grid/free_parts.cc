#include <stroma/grid/background_grid.h>
#include <stroma/grid/free_parts.h>

#include <gtest/gtest.h>

#include <functional>

using namespace Stroma;

namespace
{
  constexpr unsigned int n = 16;

  /// A sheet of n x n cells of 1 m of which some hold material; the lowest row of nodes is held.
  struct Sheet
  {
    explicit Sheet(const std::vector<std::string> &rows)
      : file(ParameterFile::parse(
          "set Dimension = 2\n"
          "subsection Materials\n subsection gel\n set Law = neo-Hookean\n set Shear modulus = 1\n"
          " set Bulk modulus = 2\n end\nend\n"
          "subsection Bodies\n subsection sheet\n set Shape = box\n set Upper corner = 16, 16\n end\nend\n"
          "subsection Loads\n subsection weight\n set Where = all\n set Force density = 0; -1\n end\nend\n",
          "test.prm"))
      , parameters(file)
      , scene(parameters, MPI_COMM_WORLD)
      , grid(box(), shape_functions<2>().front(), MPI_COMM_WORLD)
    {
      holds.assign(grid.triangulation.n_active_cells(), false);
      for (const auto &cell : grid.triangulation.active_cell_iterators())
        if (cell->is_locally_owned())
          {
            const auto centre                = cell->center();
            const auto row                   = n - 1 - static_cast<unsigned int>(centre[1]),
                       column                = static_cast<unsigned int>(centre[0]);
            holds[cell->active_cell_index()] = row < rows.size() && rows[row][column] == '#';
          }
      parts = std::make_unique<ConnectedParts<2>>(grid.triangulation, holds);
    }

    static GridBox<2>
    box()
    {
      GridBox<2> box;
      box.cell_size = dealii::Tensor<1, 2>({1., 1.});
      box.n_cells   = {{n, n}};
      return box;
    }

    /// What is free if the lowest row is held in both components.
    FreeParts<2>
    find() const
    {
      FreeParts<2> free(scene, *parts);
      for (const auto &cell : grid.triangulation.active_cell_iterators())
        if (cell->is_locally_owned() && holds[cell->active_cell_index()])
          {
            free.add_cell(cell, 0);
            for (const unsigned int v : cell->vertex_indices())
              for (unsigned int c = 0; c < 2; ++c)
                if (cell->vertex(v)[1] == 0.)
                  free.motions.hold(parts->piece_of(cell), cell->vertex(v), c);
          }
      free.find();
      return free;
    }

    /// Loads every cell by @p force at its centre.
    void
    load(const FreeParts<2> &free, const dealii::Tensor<1, 2> &force) const
    {
      free.check_loads(1., [&](const double, const auto &add) {
        for (const auto &cell : grid.triangulation.active_cell_iterators())
          if (cell->is_locally_owned() && holds[cell->active_cell_index()])
            add(parts->piece_of(cell), cell->center(), force);
      });
    }

    ParameterFile                      file;
    Parameters                         parameters;
    Scene<2>                           scene;
    BackgroundGrid<2>                  grid;
    std::vector<bool>                  holds;
    std::unique_ptr<ConnectedParts<2>> parts;
  };

  const std::string full(n, '#'), none(n, '.');

  /// @p top, then full rows to the bottom.
  std::vector<std::string>
  on_a_block(std::vector<std::string> top)
  {
    top.resize(n, full);
    return top;
  }

  std::string
  message_of(const std::function<void()> &act)
  {
    try
      {
        act();
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }
} // namespace

TEST(MpiConnectedParts, ASnakeIsOnePiece)
{
  std::vector<std::string> rows;
  for (unsigned int i = 0; i < n; ++i)
    rows.push_back(i % 2 == 0 ? full : i % 4 == 1 ? "#" + std::string(n - 1, '.') : std::string(n - 1, '.') + "#");
  const Sheet sheet(rows);
  EXPECT_EQ(sheet.parts->size(), 1u);
  EXPECT_EQ(sheet.find().count(), 0u);
  EXPECT_EQ(sheet.find().words(), "");
}

TEST(MpiConnectedParts, SingleCellsArePiecesOfTheirOwn)
{
  std::vector<std::string> rows(n, none);
  for (unsigned int i = 0; i < n; i += 2)
    for (unsigned int k = 0; k < n; k += 2)
      rows[i][k] = '#';
  EXPECT_EQ(Sheet(rows).parts->size(), n * n / 4);
}

TEST(MpiFreeParts, AnIslandIsSaidAndIsRefusedUnderALoad)
{
  const Sheet sheet(on_a_block({none, "....##..........", none, none}));
  const auto  free = sheet.find();
  EXPECT_EQ(free.count(), 1u);
  EXPECT_EQ(free.words(),
            "there is 1 piece of material (1.03093 % of the volume) that touches no support: 2 x 1 m, around "
            "(5, 14.5) m, of material 'gel'. No load drives them, so they do no harm");
  EXPECT_EQ(message_of([&] { sheet.load(free, dealii::Tensor<1, 2>()); }), "");
  EXPECT_NE(message_of([&] {
              sheet.load(free, dealii::Tensor<1, 2>({0., -1.}));
            }).find("loads act on 1 piece of material"),
            std::string::npos);
}

TEST(MpiFreeParts, WhatHangsOnACornerTurnsUnderALoad)
{
  const Sheet sheet(on_a_block({"..........######", "##########......", "#########.......", none}));
  ASSERT_EQ(sheet.parts->size(), 3u); // the upper ones share a corner, the block below is apart
  const Sheet hinge(on_a_block({none, "....##..........", "......##########"}));
  const auto  free = hinge.find();
  EXPECT_EQ(free.count(), 1u);
  EXPECT_NE(message_of([&] {
              hinge.load(free, dealii::Tensor<1, 2>({0., -1.}));
            }).find("is held too loosely"),
            std::string::npos);
  // Towards its corner, along the line from its centre (5, 14.5) to (6, 14), a load has no moment.
  EXPECT_EQ(message_of([&] { hinge.load(free, dealii::Tensor<1, 2>({1., -.5})); }), "");
}

TEST(MpiFreeParts, TwoCornersHoldAPieceAndThreeHingesMakeATriangle)
{
  // The bridge touches the block at two corners.
  EXPECT_EQ(Sheet(on_a_block({none, "....########....", "####........####"})).find().count(), 0u);
  // An arch of two pieces: hinged at both feet and at the crown.
  const Sheet arch(on_a_block(
    {none, "....####........", "....#.#.####....", "....#......#....", "....#......#....", "####........####"}));
  EXPECT_EQ(arch.find().count(), 0u);
  // A chain of three pieces between two feet gives way.
  EXPECT_EQ(Sheet(on_a_block({none, "......####......", "....##....##....", "####........####"})).find().count(), 1u);
}

TEST(MpiFreeParts, ManyHeldPlacesDoNotHideTwoPins)
{
  const Sheet     sheet(on_a_block({}));
  RigidMotions<2> motions(sheet.scene, 1);
  for (unsigned int i = 0; i < 200000; ++i)
    motions.hold(0, dealii::Point<2>(0., 0.), 0);
  motions.hold(0, dealii::Point<2>(0., 0.), 1);
  motions.hold(0, dealii::Point<2>(1e-4, 0.), 1);
  motions.gather();
  EXPECT_EQ(message_of([&] { motions.check_whole(); }), "");
  EXPECT_TRUE(motions.free_groups().empty());
}

TEST(MpiFreeParts, RollersAloneLeaveABodyFree)
{
  const Sheet     sheet(on_a_block({}));
  RigidMotions<2> motions(sheet.scene, 1);
  for (unsigned int i = 0; i < 100; ++i)
    motions.hold(0, dealii::Point<2>(.16 * i, 0.), 1);
  motions.gather();
  EXPECT_NE(message_of([&] { motions.check_whole(); }).find("free to move along x"), std::string::npos);
}
