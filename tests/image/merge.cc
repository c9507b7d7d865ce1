#include <stroma/image/merge.h>

#include "temporary_folder.h"

#include <cstdint>

using namespace Stroma::Image;

namespace
{
  Volume<std::uint8_t>
  labels(const std::array<unsigned int, 3> &size, const std::vector<std::uint8_t> &values)
  {
    return {size, {{1e-6, 2e-6, 3e-6}}, {{0, 0, 0}}, values};
  }
} // namespace

TEST(MergeLabels, MajorityAndTies)
{
  // Blocks of 2 x 2: {1 1 1 0} -> 1, {0 1 1 0} -> 0 (tie), {5 5 9 0} -> 5, {3 2 1 0} -> 0.
  const auto merged = merge_labels(labels({{4, 4, 1}}, {1, 1, 0, 1, 1, 0, 1, 0, 5, 9, 3, 2, 5, 0, 1, 0}), {{2, 2, 1}});
  EXPECT_EQ(merged.size, (std::array<unsigned int, 3>{{2, 2, 1}}));
  EXPECT_EQ(merged.data, (std::vector<std::uint8_t>{1, 0, 5, 0}));
  EXPECT_EQ(merged.n_ties, 2u);
  EXPECT_DOUBLE_EQ(merged.voxel_size[0], 2e-6);
  EXPECT_DOUBLE_EQ(merged.voxel_size[1], 4e-6);
  EXPECT_DOUBLE_EQ(merged.voxel_size[2], 3e-6);
}

TEST(MergeLabels, ThreeDimensions)
{
  const auto merged = merge_labels(labels({{3, 1, 4}}, {7, 0, 0, 7, 7, 0, 0, 0, 2, 2, 2, 0}), {{3, 1, 2}});
  EXPECT_EQ(merged.size, (std::array<unsigned int, 3>{{1, 1, 2}}));
  EXPECT_EQ(merged.data, (std::vector<std::uint8_t>{0, 0}));
  EXPECT_EQ(merged.n_ties, 2u); // {7 0 0 7 7 0} and {0 0 2 2 2 0}
  EXPECT_EQ(merge_labels(labels({{3, 1, 1}}, {7, 7, 2}), {{3, 1, 1}}).data, (std::vector<std::uint8_t>{7}));
}

TEST(MergeLabels, RefusesBlocksThatDoNotFit)
{
  const auto volume = labels({{4, 3, 1}}, std::vector<std::uint8_t>(12, 0));
  expect_user_error([&] { merge_labels(volume, {{2, 2, 1}}); }, "along y", "3 voxels");
  expect_user_error([&] { merge_labels(volume, {{0, 1, 1}}); }, "along x");
}
