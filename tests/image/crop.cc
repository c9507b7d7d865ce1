#include <stroma/image/crop.h>

#include "temporary_folder.h"

#include <cstdint>

using namespace Stroma::Image;

namespace
{
  /// 4 x 3 x 2 voxels of value 100 z + 10 y + x.
  Volume<std::uint16_t>
  counted()
  {
    Volume<std::uint16_t> volume{{{4, 3, 2}}, {{1e-6, 2e-6, 5e-6}}, {{0, 0, 1e-6}}, {}};
    for (unsigned int z = 0; z < 2; ++z)
      for (unsigned int y = 0; y < 3; ++y)
        for (unsigned int x = 0; x < 4; ++x)
          volume.data.push_back(100 * z + 10 * y + x);
    return volume;
  }
} // namespace

TEST(Crop, TakesTheVoxelsAndTheirPlace)
{
  const auto part = crop(counted(), {{1, 1, 0}}, {{2, 2, 2}});
  EXPECT_EQ(part.data, (std::vector<std::uint16_t>{11, 12, 21, 22, 111, 112, 121, 122}));
  EXPECT_EQ(part.voxel_size, counted().voxel_size);
  EXPECT_DOUBLE_EQ(part.origin[0], 1e-6);
  EXPECT_DOUBLE_EQ(part.origin[1], 2e-6);
  EXPECT_DOUBLE_EQ(part.origin[2], 1e-6);
}

TEST(Crop, Slice)
{
  const auto slice = crop(counted(), {{0, 0, 1}}, {{4, 3, 1}});
  EXPECT_EQ(slice.size[2], 1u);
  EXPECT_EQ(slice.data.front(), 100);
  EXPECT_EQ(slice.data.back(), 123);
  EXPECT_DOUBLE_EQ(slice.origin[2], 6e-6);
}

TEST(Crop, RefusesWhatIsOutside)
{
  expect_user_error([] { crop(counted(), {{0, 0, 2}}, {{4, 3, 1}}); }, "along z", "has 2");
  expect_user_error([] { crop(counted(), {{0, 1, 0}}, {{4, 3, 1}}); }, "along y");
  expect_user_error([] { crop(counted(), {{4294967295u, 0, 0}}, {{2, 1, 1}}); }, "along x");
  expect_user_error([] { crop(counted(), {{0, 0, 0}}, {{0, 3, 1}}); }, "along x");
}
