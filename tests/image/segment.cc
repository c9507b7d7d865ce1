#include <stroma/image/hysteresis.h>
#include <stroma/image/overlap.h>
#include <stroma/image/pieces.h>
#include <stroma/image/segment.h>
#include <stroma/image/smooth.h>
#include <stroma/image/thickness.h>

#include "temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace Stroma::Image;

namespace
{
  Volume<float>
  noise(const std::array<unsigned int, 3> &size, const unsigned int seed)
  {
    std::mt19937  engine(seed);
    Volume<float> volume{size, {{1e-6, 1e-6, 2e-6}}, {{0, 0, 0}}, {}};
    for (std::size_t i = 0; i < volume.n_voxels(); ++i)
      volume.data.push_back(engine() % 256);
    return volume;
  }

  Volume<std::uint8_t>
  plane_mask(const std::vector<std::string> &rows)
  {
    Volume<std::uint8_t> mask{{{unsigned(rows[0].size()), unsigned(rows.size()), 1}},
                              {{1e-6, 1e-6, 1e-6}},
                              {{0, 0, 0}},
                              {}};
    for (const auto &row : rows)
      for (const char c : row)
        mask.data.push_back(c == '#');
    return mask;
  }

  template <typename Function>
  Volume<std::uint8_t>
  mask_of(const std::array<unsigned int, 3> &size, const std::array<double, 3> &voxel, const Function &is_inside)
  {
    Volume<std::uint8_t> mask{size, voxel, {{0, 0, 0}}, std::vector<std::uint8_t>(size[0] * size[1] * size[2], 0)};
    for (unsigned int z = 0; z < size[2]; ++z)
      for (unsigned int y = 0; y < size[1]; ++y)
        for (unsigned int x = 0; x < size[0]; ++x)
          mask.at(x, y, z) = is_inside((x + .5) * voxel[0], (y + .5) * voxel[1], (z + .5) * voxel[2]);
    return mask;
  }
} // namespace

TEST(Smooth, MedianEqualsSorting)
{
  const auto image  = noise({{9, 8, 7}}, 1);
  const auto smooth = median(image, {{1, 2, 1}});
  const auto near   = [](const int i, const int shift, const unsigned int n) {
    return std::clamp(i + shift, 0, int(n) - 1);
  };
  for (unsigned int z = 0; z < 7; ++z)
    for (unsigned int y = 0; y < 8; ++y)
      for (unsigned int x = 0; x < 9; ++x)
        {
          std::vector<float> box;
          for (int k = -1; k <= 1; ++k)
            for (int j = -2; j <= 2; ++j)
              for (int i = -1; i <= 1; ++i)
                box.push_back(image.at(near(x, i, 9), near(y, j, 8), near(z, k, 7)));
          std::sort(box.begin(), box.end());
          ASSERT_EQ(smooth.at(x, y, z), box[box.size() / 2]);
        }
}

TEST(Smooth, GaussianHasItsWidthInMetres)
{
  Volume<float> impulse{{{31, 31, 31}}, {{1e-6, 1e-6, 2e-6}}, {{0, 0, 0}}, std::vector<float>(31 * 31 * 31, 0)};
  impulse.at(15, 15, 15) = 1;
  const auto smooth      = gaussian(impulse, 2e-6);
  double     sum = 0, xx = 0, zz = 0;
  for (unsigned int z = 0; z < 31; ++z)
    for (unsigned int y = 0; y < 31; ++y)
      for (unsigned int x = 0; x < 31; ++x)
        {
          const double value = smooth.at(x, y, z);
          sum += value;
          xx += value * std::pow((x - 15.) * 1e-6, 2);
          zz += value * std::pow((z - 15.) * 2e-6, 2);
        }
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_NEAR(xx, 4e-12, .01 * 4e-12); // the tail is cut off
  EXPECT_NEAR(zz, 4e-12, .01 * 4e-12);
}

TEST(Smooth, AGaussianOfTheWidestHasTheCoefficientsOfLindeberg)
{
  Volume<float> impulse{{{81, 81, 1}}, {{1e-6, 1e-6, 1e-6}}, {{0, 0, 0}}, std::vector<float>(81 * 81, 0)};
  impulse.at(40, 40, 0) = 1;
  const auto   smooth   = gaussian(impulse, 8e-6);
  const double t = 64, middle = std::exp(-t) * std::cyl_bessel_i(0., t);
  for (unsigned int n = 0; n <= 16; ++n)
    {
      const double coefficient = std::exp(-t) * std::cyl_bessel_i(double(n), t);
      EXPECT_NEAR(smooth.at(40 + n, 40, 0), middle * coefficient, 2e-3 * middle * coefficient) << n; // .1 % is cut off
    }
  expect_user_error([&] { gaussian(impulse, 9e-6); }, "9 um", "8 edges");
}

TEST(Pieces, AreNumberedFromTheLargest)
{
  const auto mask  = plane_mask({"#..##", "...##", "#.#..", "#....", "#...#"});
  const auto faces = find_pieces(mask, Connectivity::faces);
  EXPECT_EQ(faces.size, (std::vector<std::size_t>{4, 3, 1, 1, 1}));
  EXPECT_EQ(faces.number.at(3, 0, 0), 1u);
  EXPECT_EQ(faces.number.at(0, 4, 0), 2u);
  EXPECT_EQ(faces.number.at(0, 0, 0), 3u);
  EXPECT_EQ(faces.number.at(2, 2, 0), 4u);
  EXPECT_EQ(faces.number.at(1, 1, 0), 0u);
  EXPECT_EQ(find_pieces(mask, Connectivity::full).size, (std::vector<std::size_t>{5, 3, 1, 1}));
  EXPECT_TRUE(find_pieces(plane_mask({"..."}), Connectivity::full).size.empty());
}

TEST(Pieces, ClosingFillsGapsNarrowerThanTheBall)
{
  auto mask = plane_mask({"#######", "###.###", "###.###", "#######", ".......", "#######"});
  close_gaps(mask, 1e-6);
  EXPECT_EQ(mask.data, plane_mask({"#######", "#######", "#######", "#######", ".#####.", "#######"}).data);
  auto       wide   = plane_mask({"##...##", "##...##", "##...##"});
  const auto before = wide.data;
  close_gaps(wide, 1e-6);
  EXPECT_EQ(wide.data, before);
  expect_user_error([&] { close_gaps(wide, .5e-6); }, "less than a voxel");
  expect_user_error([&] { close_gaps(wide, 51e-6); }, "50 edges");
}

TEST(Thickness, OfAPlateATubeAndNothing)
{
  const auto middle = [](const std::vector<double> &sorted) { return sorted[sorted.size() / 2]; };
  const auto plate  = mask_of({{20, 20, 15}}, {{1e-6, 1e-6, 1e-6}},
                              [](double, double, const double z) { return z > 4e-6 && z < 11e-6; });
  EXPECT_NEAR(middle(ridge_thickness(plate)), 7.5e-6, 1e-12);
  const auto tube = mask_of({{41, 41, 10}}, {{1e-6, 1e-6, 2e-6}}, [](const double x, const double y, double) {
    return std::hypot(x - 20.5e-6, y - 20.5e-6) < 10e-6;
  });
  EXPECT_NEAR(middle(ridge_thickness(tube)), 20e-6, 1e-6);
  EXPECT_TRUE(ridge_thickness(plane_mask({"###"})).empty());
  EXPECT_TRUE(ridge_thickness(plane_mask({"..."})).empty());
}

TEST(Overlaps, CountBothAndEither)
{
  const auto found = overlaps({0, 1, 1, 2, 1}, {0, 1, 2, 2, 0});
  EXPECT_EQ(found[1].first, 3u);
  EXPECT_EQ(found[1].second, 1u);
  EXPECT_EQ(found[1].both, 1u);
  EXPECT_DOUBLE_EQ(found[1].dice(), .5);
  EXPECT_DOUBLE_EQ(found[1].jaccard(), 1. / 3);
  EXPECT_DOUBLE_EQ(found[7].dice(), 1);
}

TEST(Segment, DoesItsPartsInTurn)
{
  const auto      image = noise({{30, 25, 9}}, 5);
  SegmentSettings settings;
  settings.smoothing      = Smoothing::median;
  settings.lower.kind     = Threshold::Kind::otsu;
  settings.upper.kind     = Threshold::Kind::percentile;
  settings.upper.value    = 80;
  settings.smallest_piece = 20;
  const auto result       = segment(image, settings);
  const auto smooth       = median(image, {{1, 1, 1}});
  EXPECT_GT(result.upper, result.lower);
  auto       right  = hysteresis_threshold(smooth, result.lower, result.upper, Connectivity::faces);
  const auto pieces = find_pieces(right, Connectivity::faces);
  ASSERT_LT(pieces.size.back(), 20u); // so that there is something to leave out
  for (std::size_t i = 0; i < right.data.size(); ++i)
    if (right.data[i] != 0 && pieces.size[pieces.number.data[i] - 1] < 20)
      right.data[i] = 0;
  EXPECT_EQ(result.mask.data, right.data);
  EXPECT_EQ(result.n_largest, pieces.size.front());
  settings.largest_only = true;
  EXPECT_EQ(std::accumulate(right.data.begin(), right.data.end(), 0u) > pieces.size.front(), pieces.size[1] >= 20);
  const auto largest = segment(image, settings).mask;
  EXPECT_EQ(std::accumulate(largest.data.begin(), largest.data.end(), std::size_t(0)), pieces.size.front());
}
