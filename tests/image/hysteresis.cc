#include <stroma/image/hysteresis.h>

#include "temporary_folder.h"

#include <cstdlib>
#include <limits>
#include <random>

using namespace Stroma::Image;

namespace
{
  template <typename T>
  Volume<T>
  random_volume(const std::array<unsigned int, 3> &size, const unsigned int largest, std::mt19937 &engine)
  {
    Volume<T> volume{size, {{1e-6, 2e-6, 3e-6}}, {{1, 2, 3}}, {}};
    for (std::size_t i = 0; i < volume.n_voxels(); ++i)
      volume.data.push_back(engine() % (largest + 1));
    return volume;
  }

  /// Hysteresis by flooding from the seeds, voxel by voxel.
  template <typename T>
  std::vector<std::uint8_t>
  flood(const Volume<T> &image, const double lower, const double upper, const bool full)
  {
    std::vector<std::uint8_t>       reached(image.data.size(), 0);
    std::vector<std::array<int, 3>> front;
    const auto                      visit = [&](const int x, const int y, const int z, const double threshold) {
      const auto i = image.index(x, y, z);
      if (!reached[i] && image.data[i] >= threshold)
        {
          reached[i] = 1;
          front.push_back({{x, y, z}});
        }
    };
    const int nx = image.size[0], ny = image.size[1], nz = image.size[2];
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
          visit(x, y, z, upper);
    while (!front.empty())
      {
        const auto [x, y, z] = front.back();
        front.pop_back();
        for (int k = std::max(z - 1, 0); k <= std::min(z + 1, nz - 1); ++k)
          for (int j = std::max(y - 1, 0); j <= std::min(y + 1, ny - 1); ++j)
            for (int i = std::max(x - 1, 0); i <= std::min(x + 1, nx - 1); ++i)
              if (full || std::abs(i - x) + std::abs(j - y) + std::abs(k - z) == 1)
                visit(i, j, k, lower);
      }
    return reached;
  }

  template <typename T>
  void
  compare_with_flood(const std::array<unsigned int, 3> &size, const unsigned int largest)
  {
    std::mt19937 engine(largest + size[0]);
    for (unsigned int trial = 0; trial < 9; ++trial)
      {
        const auto image = random_volume<T>(size, largest, engine);
        // At last the two are equal: a plain threshold.
        const double lower = (0.55 + 0.05 * trial) * largest, upper = trial < 8 ? 0.96 * largest : lower;
        for (const bool full : {false, true})
          {
            const auto result = hysteresis_threshold(image, lower, upper,
                                                     full ? Connectivity::full : Connectivity::faces);
            EXPECT_EQ(result.data, flood(image, lower, upper, full)) << "trial " << trial << " full " << full;
            EXPECT_EQ(result.size, image.size);
            EXPECT_EQ(result.voxel_size, image.voxel_size);
            EXPECT_EQ(result.origin, image.origin);
          }
      }
  }

  Volume<std::uint8_t>
  row(const std::vector<std::uint8_t> &values)
  {
    return {{{unsigned(values.size()), 1, 1}}, {{1e-6, 1e-6, 1e-6}}, {{0, 0, 0}}, values};
  }

  std::vector<std::uint8_t>
  threshold(const std::vector<std::uint8_t> &values, const double lower, const double upper)
  {
    return hysteresis_threshold(row(values), lower, upper, Connectivity::faces).data;
  }

  using Labels = std::vector<std::uint8_t>;
} // namespace

TEST(Hysteresis, EqualsFloodFill)
{
  compare_with_flood<std::uint8_t>({{23, 17, 11}}, 255);
  compare_with_flood<std::uint16_t>({{19, 23, 5}}, 65535);
  compare_with_flood<std::uint8_t>({{61, 47, 1}}, 200);
}

TEST(Hysteresis, ConnectivityMatters)
{
  Volume<std::uint8_t> diagonal{{{2, 2, 1}}, {{1, 1, 1}}, {{0, 0, 0}}, {200, 0, 0, 100}};
  EXPECT_EQ(hysteresis_threshold(diagonal, 100, 200, Connectivity::faces).data, (Labels{1, 0, 0, 0}));
  EXPECT_EQ(hysteresis_threshold(diagonal, 100, 200, Connectivity::full).data, (Labels{1, 0, 0, 1}));
}

TEST(Hysteresis, ThresholdsAreInclusive)
{
  EXPECT_EQ(threshold({53, 156, 52, 53, 155, 0}, 53, 156), (Labels{1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(threshold({53, 156, 52, 53, 155, 0}, 52.5, 155.5), (Labels{1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(threshold({9, 10, 11, 0}, 10, 10), (Labels{0, 1, 1, 0}));
}

TEST(Hysteresis, ThresholdsOutsideTheValues)
{
  EXPECT_EQ(threshold({0, 255}, -5, 0), (Labels{1, 1}));
  EXPECT_EQ(threshold({0, 255}, 255, 255), (Labels{0, 1}));
  EXPECT_EQ(threshold({0, 255}, 10, 255.5), (Labels{0, 0}));
  EXPECT_EQ(threshold({0, 255}, 300, 400), (Labels{0, 0}));
}

TEST(Hysteresis, RefusesWrongThresholds)
{
  expect_user_error([] { threshold({1}, 3, 2); }, "threshold 3 must", "threshold 2");
  expect_user_error([] { threshold({1}, std::numeric_limits<double>::quiet_NaN(), 2); }, "threshold");
}
