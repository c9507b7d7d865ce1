#include <stroma/output/point_results.h>

#include <gtest/gtest.h>

#include <numeric>

using namespace Stroma::Output;

namespace
{
  /// Points 0 to 9 on each rank: of volume 1, under a pressure of their number, even ones of material 0.
  class TenPoints : public StateView
  {
  public:
    std::size_t
    n_points() const override
    {
      return 10;
    }
    void
    for_each_point(const Visit &visit) const override
    {
      for (unsigned int i = 0; i < 10; ++i)
        {
          PointState point;
          point.V0           = 1.;
          point.material     = i % 2;
          point.pressure     = i;
          point.u[0]         = i;
          point.cauchy[0][0] = i;
          visit(point);
        }
    }
    void
    sample(const StateFields &, Samples &) const override
    {}
  };
} // namespace

TEST(PointResults, MpiOfEachGroupAndOfAll)
{
  PointRequest request{2, true, false, {}};
  request.groups.push_back({{"gel", "vessel", "unused"}, [](const PointState &p) { return p.material; }, {"pressure"}});
  std::map<std::string, double> results;
  add_point_results(TenPoints(), request, MPI_COMM_WORLD, results);
  const double n = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  EXPECT_EQ(results.at("volume_gel_m3"), 5. * n);
  EXPECT_EQ(results.at("fraction_vessel"), .5);
  EXPECT_EQ(results.at("von_mises_mean_gel_Pa"), 4.);
  EXPECT_EQ(results.at("pressure_mean_vessel_Pa"), 5.);
  EXPECT_EQ(results.at("pressure_p01_vessel_Pa"), 1.);
  EXPECT_EQ(results.at("pressure_p50_vessel_Pa"), 5.);
  EXPECT_EQ(results.at("pressure_p99_vessel_Pa"), 9.);
  EXPECT_EQ(results.at("volume_unused_m3"), 0.);
  EXPECT_EQ(results.count("pressure_mean_unused_Pa"), 0u);
  EXPECT_EQ(results.at("max_displacement_m"), 9.);
  EXPECT_EQ(results.at("max_von_mises_Pa"), 9.);
  EXPECT_EQ(results.count("max_speed_m_per_s"), 0u);
}

TEST(PointResults, ALargestDisplacementThatIsKnownStays)
{
  std::map<std::string, double> results{{"max_displacement_m", 11.}};
  add_point_results(TenPoints(), {2, true, false, {}}, MPI_COMM_WORLD, results);
  EXPECT_EQ(results.at("max_displacement_m"), 11.);
}

TEST(PointResults, MpiHistogramsOfAKindHaveTheSameBins)
{
  PointRequest request{2, true, false, {}};
  request.groups.push_back(
    {{"gel", "vessel, soft", "unused"}, [](const PointState &p) { return p.material; }, {"pressure"}});
  std::map<std::string, double> results;
  const auto list = add_point_results(TenPoints(), request, MPI_COMM_WORLD, results)->histograms(MPI_COMM_WORLD);
  ASSERT_EQ(list.size(), 2u); // nothing of what no point is made of
  EXPECT_EQ(list[1].group, "vessel, soft");
  for (const auto &one : list)
    {
      EXPECT_EQ(one.field + one.unit, "pressurePa");
      ASSERT_EQ(one.edges.size(), 51u);
      EXPECT_EQ(one.edges.front(), 0.); // of all groups: gel has 0 to 8, the other 1 to 9
      EXPECT_EQ(one.edges.back(), 9.);
      EXPECT_NEAR(std::accumulate(one.fractions.begin(), one.fractions.end(), 0.), 1., 1e-14);
    }
  EXPECT_EQ(list[0].edges, list[1].edges);
  EXPECT_NEAR(list[0].fractions[1], .2, 1e-14);     // 0 of 0, 2, 4, 6, 8
  EXPECT_NEAR(list[1].fractions.back(), .2, 1e-14); // 9, the upper end
  EXPECT_NE(histogram_table(list).find("\n\"vessel, soft\",pressure,Pa,"), std::string::npos) << histogram_table(list);
}
