#include <stroma/image/automatic_threshold.h>

#include "temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <random>

using namespace Stroma::Image;

namespace
{
  /// Whole numbers in two normal clusters.
  std::vector<float>
  two_clusters(const unsigned int n, const unsigned int seed, const double low, const double high)
  {
    std::mt19937               engine(seed);
    std::normal_distribution<> noise(0., 1.);
    std::vector<float>         values;
    for (unsigned int i = 0; i < n; ++i)
      values.push_back(std::lround(std::clamp((i % 4 == 0 ? high : low) + .1 * high * noise(engine), 0., 65535.)));
    return values;
  }

  /// Otsu's threshold by trying all: the value from which the upper class begins.
  double
  otsu_by_trying(const std::vector<float> &values)
  {
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    double total = 0, below = 0, best = -1, threshold = 0;
    for (const float value : sorted)
      total += value;
    for (std::size_t n = 1; n < sorted.size(); ++n)
      {
        below += sorted[n - 1];
        if (sorted[n] == sorted[n - 1])
          continue;
        const double m = sorted.size() - n, difference = below / n - (total - below) / m;
        if (n * m * difference * difference > best * (1 + 1e-12))
          {
            best      = n * m * difference * difference;
            threshold = sorted[n - 1] + 1;
          }
      }
    return threshold;
  }
} // namespace

TEST(Histogram, WholeNumbersHaveABinEach)
{
  const auto histogram = histogram_of({3, 5, 5, 3, 3, 258});
  EXPECT_TRUE(histogram.is_exact);
  EXPECT_EQ(histogram.lowest, 3);
  EXPECT_EQ(histogram.width, 1);
  ASSERT_EQ(histogram.count.size(), 256u);
  EXPECT_EQ(histogram.count[0], 3u);
  EXPECT_EQ(histogram.count[2], 2u);
  EXPECT_EQ(histogram.count[255], 1u);
  EXPECT_EQ(histogram.n_from(-4), 6u);
  EXPECT_EQ(histogram.n_from(3), 6u);
  EXPECT_EQ(histogram.n_from(4.5), 3u);
  EXPECT_EQ(histogram.n_from(258), 1u);
  EXPECT_EQ(histogram.n_from(259), 0u);
}

TEST(Histogram, OtherValuesHaveEqualBins)
{
  const auto histogram = histogram_of({-.5, 0, .25, .5});
  EXPECT_FALSE(histogram.is_exact);
  ASSERT_EQ(histogram.count.size(), 256u);
  EXPECT_DOUBLE_EQ(histogram.edge(256), .5);
  EXPECT_EQ(histogram.count[0], 1u);
  EXPECT_EQ(histogram.count[128], 1u);
  EXPECT_EQ(histogram.count[255], 1u); // the highest value belongs to the last bin
}

TEST(Histogram, PercentilesAreThoseOfTheSortedValues)
{
  for (const float scale : {1.f, .01f}) // from counts, and by sorting
    {
      std::vector<float> values = two_clusters(997, 3, 50, 180);
      for (float &value : values)
        value *= scale;
      std::vector<float> sorted = values;
      std::sort(sorted.begin(), sorted.end());
      const std::vector<double> shares = {0, 1, 12.5, 50, 77.7, 100};
      const auto                found  = percentiles(values, histogram_of(values), shares);
      for (unsigned int i = 0; i < shares.size(); ++i)
        {
          const double      place = shares[i] / 100 * 996;
          const std::size_t rank  = std::min<std::size_t>(place, 995);
          EXPECT_DOUBLE_EQ(found[i], sorted[rank] + (place - rank) * (double(sorted[rank + 1]) - sorted[rank]));
        }
    }
}

TEST(AutomaticThreshold, OtsuHasTheLargestVarianceBetweenClasses)
{
  for (const double high : {180., 1800., 30000.})
    for (unsigned int seed = 1; seed < 4; ++seed)
      {
        const auto values = two_clusters(4000, seed, .3 * high, high);
        EXPECT_EQ(automatic_threshold(histogram_of(values), AutomaticThreshold::otsu), otsu_by_trying(values));
      }
}

TEST(AutomaticThreshold, TwoValues)
{
  const auto histogram = histogram_of({7, 7, 7, 9, 9});
  EXPECT_EQ(automatic_threshold(histogram, AutomaticThreshold::otsu), 8);
  EXPECT_LE(automatic_threshold(histogram, AutomaticThreshold::triangle), 9);
  EXPECT_GT(automatic_threshold(histogram, AutomaticThreshold::triangle), 7);
  const auto peak_at_the_end = histogram_of({7, 9, 9, 9, 9, 9});
  EXPECT_GT(automatic_threshold(peak_at_the_end, AutomaticThreshold::triangle), 7);
  EXPECT_LE(automatic_threshold(peak_at_the_end, AutomaticThreshold::triangle), 9);
}

TEST(AutomaticThreshold, TriangleLiesAtTheFootOfThePeak)
{
  // A steep peak at 20, then a tail that is straight from 30 to 130: the knee is at 30.
  std::vector<float> values;
  for (unsigned int v = 0; v < 131; ++v)
    values.insert(values.end(), v < 30 ? (v < 10 ? 0 : 1000 - 90 * std::abs(int(v) - 20)) : (v < 130 ? 5 : 0), v);
  const double threshold = automatic_threshold(histogram_of(values), AutomaticThreshold::triangle);
  EXPECT_GE(threshold, 30);
  EXPECT_LE(threshold, 33);
}

TEST(AutomaticThreshold, FloatingPointValues)
{
  auto         values = two_clusters(5000, 8, 50, 200);
  const double whole  = automatic_threshold(histogram_of(values), AutomaticThreshold::otsu);
  for (float &value : values)
    value = .001f * value - 3;
  EXPECT_NEAR(automatic_threshold(histogram_of(values), AutomaticThreshold::otsu), .001 * whole - 3, .003);
}

TEST(AutomaticThreshold, RefusesOneValue)
{
  for (const auto method : {AutomaticThreshold::otsu, AutomaticThreshold::triangle})
    expect_user_error([&] { automatic_threshold(histogram_of({17, 17}), method); }, "one value only, 17");
}
