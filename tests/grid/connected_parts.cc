#include <stroma/grid/connected_parts.h>

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  using Triangulation = dealii::parallel::distributed::Triangulation<2>;

  /// 8 x 8 cells of 1 m, which may repeat along x.
  struct PeriodicSheet
  {
    explicit PeriodicSheet(const bool repeats)
      : triangulation(MPI_COMM_WORLD)
    {
      dealii::GridGenerator::hyper_cube(triangulation, 0., 8., true);
      if (repeats)
        {
          std::vector<dealii::GridTools::PeriodicFacePair<Triangulation::cell_iterator>> pairs;
          dealii::GridTools::collect_periodic_faces(triangulation, 0, 1, 0, pairs);
          triangulation.add_periodicity(pairs);
        }
      triangulation.refine_global(3);
    }

    template <typename Holds>
    ConnectedParts<2>
    parts(const Holds &holds)
    {
      std::vector<bool> material(triangulation.n_active_cells(), false);
      for (const auto &cell : triangulation.active_cell_iterators())
        material[cell->active_cell_index()] = cell->is_locally_owned() && holds(cell->center()[0], cell->center()[1]);
      return {triangulation, material};
    }

    Triangulation triangulation;
  };

  bool
  in_outer_columns(const double x, double)
  {
    return x < 1. || x > 7.;
  }
} // namespace

TEST(MpiConnectedParts, HangTogetherAcrossAPeriod)
{
  PeriodicSheet apart(false), joined(true);
  const auto    two = apart.parts(in_outer_columns), one = joined.parts(in_outer_columns);
  EXPECT_EQ(two.size(), 2u);
  EXPECT_EQ(two.n_groups(), 2u);
  EXPECT_EQ(two.across_period(), (std::vector<bool>{false, false}));
  EXPECT_EQ(one.size(), 1u);
  const bool sees = !one.across_period().empty() && one.across_period()[0];
  EXPECT_TRUE(dealii::Utilities::MPI::max(sees ? 1 : 0, MPI_COMM_WORLD));
}

TEST(MpiConnectedParts, ThatShareACornerAreJoinedThere)
{
  PeriodicSheet sheet(false);
  const auto parts = sheet.parts([](const double x, const double y) { return (x < 4.) == (y < 4.); }); // two quarters
  EXPECT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts.n_groups(), 1u);
  const auto joints = parts.joints();
  for (const auto &joint : joints)
    {
      EXPECT_LT(joint.X.distance({4., 4.}), 1e-12);
      EXPECT_NE(joint.first, joint.second);
    }
  EXPECT_GE(dealii::Utilities::MPI::sum(joints.size(), MPI_COMM_WORLD), 1u);
}

TEST(MpiConnectedParts, PiecesHaveOneNumberOnAllRanks)
{
  PeriodicSheet sheet(false);
  const auto    parts = sheet.parts(in_outer_columns);
  int           left  = -1; // piece of the left column
  for (const auto &cell : sheet.triangulation.active_cell_iterators())
    if (cell->is_locally_owned())
      {
        const double x = cell->center()[0];
        if (x < 1.)
          left = parts.piece_of(cell);
        else if (x < 7.)
          {
            EXPECT_EQ(parts.piece_of(cell), parts.none());
          }
      }
  const int largest = dealii::Utilities::MPI::max(left, MPI_COMM_WORLD);
  EXPECT_TRUE(left < 0 || left == largest);
}
