// Nodes and unknowns of the background grid, on any number of ranks.

#include <stroma/grid/background_grid.h>

#include <gtest/gtest.h>

#include <map>
#include <set>

using namespace Stroma;

namespace
{
  GridBox<2>
  box(const unsigned int nx, const unsigned int ny)
  {
    GridBox<2> box;
    box.cell_size = dealii::Tensor<1, 2>({1., 1.});
    box.n_cells   = {{nx, ny}};
    return box;
  }

  /// A grid whose cells hold material in every third column.
  struct Stripes
  {
    explicit Stripes(const unsigned int shape)
      : grid(box(12, 8), shape_functions<2>()[shape], MPI_COMM_WORLD)
    {
      std::vector<bool> holds(grid.triangulation.n_active_cells(), false);
      grid.for_owned_cells(
        [&](const auto &cell, const auto &index) { holds[cell->active_cell_index()] = index[0] % 3 == 0; });
      grid.distribute_unknowns(holds);
    }

    BackgroundGrid<2> grid;
  };

  template <typename T>
  std::vector<T>
  gathered(const std::vector<T> &own)
  {
    std::vector<T> all;
    for (const auto &of_rank : dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
      all.insert(all.end(), of_rank.begin(), of_rank.end());
    return all;
  }

  TEST(NodeLattice, MpiANodeHasOneOwnerAndTheSameUnknownsOnAllRanks)
  {
    for (const unsigned int shape : {0u, 1u})
      {
        const Stripes s(shape);
        const auto   &nodes = s.grid.nodes;
        using Numbers       = std::vector<std::uint64_t>;
        Numbers owned, seen;
        for (std::size_t i = 0; i < nodes.n_nodes(); ++i)
          {
            const auto node = nodes.node(i);
            seen.insert(seen.end(), {node.name, node.unknown});
            if (nodes.owned.is_element(node.unknown))
              owned.push_back(node.name);
          }
        // Linear: 4 columns of 2 x 9 nodes; splines: 3 each of 14 columns but two, which no cell with material has.
        const unsigned int n = shape == 0 ? 8 * 9 : 12 * 10;
        owned                = gathered(owned);
        seen                 = gathered(seen);
        EXPECT_EQ(owned.size(), n);
        EXPECT_EQ(std::set<std::uint64_t>(owned.begin(), owned.end()).size(), n);
        EXPECT_EQ(nodes.n_unknowns(), 2 * n);
        std::map<std::uint64_t, std::uint64_t> unknown;
        for (std::size_t i = 0; i < seen.size(); i += 2)
          EXPECT_EQ(unknown.emplace(seen[i], seen[i + 1]).first->second, seen[i + 1]);
        EXPECT_EQ(unknown.size(), n);
      }
  }

  TEST(NodeLattice, MpiCellsFindTheirNodes)
  {
    for (const unsigned int shape : {0u, 1u})
      {
        const Stripes s(shape);
        for (const auto &active : s.grid.active_cells())
          {
            dealii::Point<2> mean;
            for (unsigned int a = 0; a < s.grid.shape->n_nodes(); ++a)
              {
                const auto node = s.grid.nodes.at(active.node[a]);
                EXPECT_EQ(s.grid.nodes.relevant.nth_index_in_set(active.node[a]), node.unknown);
                EXPECT_LT(node.X.distance(active.cell->center()), shape == 0 ? .71 : 1.42);
                mean += node.X / s.grid.shape->n_nodes();
              }
            if (shape == 0)
              {
                EXPECT_LT(mean.distance(active.cell->center()), 1e-14);
              }
          }
      }
  }

  TEST(BackgroundGrid, CoarseMeshesAreSmall)
  {
    const auto halved = coarse_mesh<3>({{64, 64, 12}});
    EXPECT_EQ(halved.n_cells, (std::array<unsigned int, 3>{{16, 16, 3}}));
    EXPECT_EQ(halved.refinements, 2u);
    EXPECT_EQ(coarse_mesh<2>({{63, 65}}).refinements, 0u); // small enough: nothing beyond the box
    for (const std::array<unsigned int, 3> &odd : {std::array<unsigned int, 3>{{511, 513, 53}}, {{129, 127, 27}}})
      {
        const auto mesh = coarse_mesh<3>(odd);
        double     n = 1., n_coarse = 1.;
        for (unsigned int d = 0; d < 3; ++d)
          {
            EXPECT_GE(mesh.n_cells[d] << mesh.refinements, odd[d]);
            n_coarse *= mesh.n_cells[d];
            n *= double(mesh.n_cells[d] << mesh.refinements) / odd[d];
          }
        EXPECT_LT(n, 1.27);
        EXPECT_LT(n_coarse, 31000.);
      }
  }

  TEST(BackgroundGrid, MpiCellsBeyondTheBoxStayEmpty)
  {
    BackgroundGrid<2> grid(box(65, 65), shape_functions<2>().front(), MPI_COMM_WORLD);
    EXPECT_EQ(grid.triangulation.n_global_active_cells(), 72u * 72u);
    unsigned int      n = 0;
    std::vector<bool> holds(grid.triangulation.n_active_cells(), false);
    grid.for_owned_cells([&](const auto &cell, const auto &index) {
      ++n;
      holds[cell->active_cell_index()] = true;
      EXPECT_NEAR(cell->center()[0], index[0] + .5, 1e-12);
    });
    grid.distribute_unknowns(holds);
    EXPECT_EQ(dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD), 65u * 65u);
    EXPECT_EQ(grid.n_active_cells(), 65u * 65u);
    EXPECT_EQ(grid.nodes.n_unknowns(), 2u * 66u * 66u);
  }
} // namespace
