#include "../world.h"

#include <stroma/output/statistics.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace Stroma::Output;

namespace
{
  using WeightedValues = std::vector<std::pair<double, double>>;

  /// The definition, on one rank.
  double
  reference(WeightedValues samples, const double q)
  {
    std::sort(samples.begin(), samples.end());
    double total = 0., sum = 0.;
    for (const auto &sample : samples)
      total += sample.second;
    for (const auto &[value, weight] : samples)
      if ((sum += weight) >= q * total)
        return value;
    return samples.back().first;
  }

  /// Gives every rank its part of the sample.
  VolumeWeightedQuantiles
  distribute(const WeightedValues &samples)
  {
    const unsigned int      rank = dealii::Utilities::MPI::this_mpi_process(world);
    const unsigned int      n    = dealii::Utilities::MPI::n_mpi_processes(world);
    VolumeWeightedQuantiles part;
    for (std::size_t i = rank; i < samples.size(); i += n)
      part.add(samples[i].first, samples[i].second);
    return part;
  }
} // namespace

TEST(VolumeWeightedQuantiles, MpiAgreesWithSorting)
{
  std::mt19937                     random(1);
  std::uniform_real_distribution<> weight(0.1, 1.);
  std::lognormal_distribution<>    skewed(0., 4.); // 16 orders of magnitude: the first histogram hardly separates
  std::normal_distribution<>       normal(-5., 2.);
  const std::vector<double>        q = {0., 0.5, 0.99, 0.999, 1., 0.25};
  for (const bool is_skewed : {true, false})
    {
      WeightedValues samples(200000);
      for (auto &sample : samples)
        sample = {is_skewed ? skewed(random) : normal(random), weight(random)};
      const auto found = distribute(samples).quantiles(q, world);
      for (std::size_t i = 0; i < q.size(); ++i)
        EXPECT_DOUBLE_EQ(found[i], reference(samples, q[i])) << q[i];
    }
}

TEST(VolumeWeightedQuantiles, MpiEqualValuesAndTies)
{
  WeightedValues samples(30000, {0., 1.});
  EXPECT_EQ(distribute(samples).quantiles({0.5, 0.99}, world), (std::vector<double>{0., 0.}));
  std::fill(samples.begin() + 15000, samples.end(), std::make_pair(7., 1.));
  EXPECT_EQ(distribute(samples).quantiles({0.4999, 0.5, 0.5001}, world), (std::vector<double>{0., 0., 7.}));
  EXPECT_EQ(distribute(samples).max(world), 7.);
}

TEST(VolumeWeightedQuantiles, MpiWeightsCount)
{
  const auto heavy = distribute({{1., 1.}, {2., 1.}, {3., 8.}});
  EXPECT_EQ(heavy.quantiles({0.1, 0.2, 0.21}, world), (std::vector<double>{1., 2., 3.}));
}

TEST(VolumeWeightedQuantiles, MpiEmpty)
{
  const VolumeWeightedQuantiles none;
  EXPECT_TRUE(std::isnan(none.quantiles({0.5}, world)[0]));
  EXPECT_EQ(none.max(world), -std::numeric_limits<double>::infinity());
}

TEST(VolumeWeightedQuantiles, MpiSharesBetweenEdgesAndBeyondThem)
{
  const WeightedValues samples = {
    {-2., 1.}, {0., 2.}, {.5, 1.}, {1., 3.}, {7., 1.}}; // an upper edge belongs to the next bin
  std::vector<double> edges = {0., 1., 2.};
  EXPECT_EQ(distribute(samples).shares(edges, world), (std::vector<double>{1. / 8, 3. / 8, 3. / 8, 1. / 8}));
  EXPECT_EQ(edges, (std::vector<double>{-2., 0., 1., 2., 7.}));
  std::vector<double> wide = {-10., 10.};
  EXPECT_EQ(distribute(samples).shares(wide, world), (std::vector<double>{0., 1., 0.}));
  EXPECT_EQ(wide, (std::vector<double>{-10., -10., 10., 10.}));
  EXPECT_TRUE(VolumeWeightedQuantiles().shares(edges, world).empty());
}
