// Kinds of numbers, tiles, and the pages of hyperstacks.

#include <stroma/image/read.h>

#include "raw_files.h"
#include "read_options.h"
#include "temporary_folder.h"

using namespace Stroma::Image;
using RawFiles::bytes;

namespace
{
  using ImageTiff = TemporaryFolder;

  const ReadOptions voxel = with_voxels({{1e-6, 1e-6, 1e-6}});

  /// Pages of 2 x 1 pixels with the values n, n.
  std::vector<RawFiles::TiffPage>
  pages(const unsigned int n, const std::string &description)
  {
    std::vector<RawFiles::TiffPage> list(n);
    for (unsigned int i = 0; i < n; ++i)
      list[i].pixels = std::string(2, static_cast<char>(i));
    list[0].description = description;
    return list;
  }

  /// The value of each slice.
  std::vector<unsigned int>
  slices(const std::string &name, const unsigned int channel, const unsigned int frame)
  {
    ReadOptions options              = voxel;
    options.channel                  = channel;
    options.frame                    = frame;
    const auto                volume = read(name, options);
    std::vector<unsigned int> found;
    for (unsigned int z = 0; z < volume.size[2]; ++z)
      found.push_back(volume.at(1, 0, z));
    return found;
  }

  std::string
  ome(const std::string &order, const std::string &sizes, const std::string &data)
  {
    return "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image ID=\"Image:0\">"
           "<Pixels DimensionOrder=\"" +
           order + "\" " + sizes + " Type=\"uint8\">" + data + "</Pixels></Image></OME>";
  }

  using Numbers = std::vector<unsigned int>;
} // namespace

TEST_F(ImageTiff, FloatingPointIsNotTakenForWholeNumbers)
{
  RawFiles::TiffPage page;
  page.bits       = 16;
  page.format     = 3;
  page.pixels     = bytes<std::uint16_t>({0x3400, 0xbc00}); // .25, -1
  const auto name = file("half.tif", RawFiles::tiff({page}));
  EXPECT_EQ(read<float>(name, voxel).data, (std::vector<float>{.25, -1}));
  expect_user_error([&] { read(name, voxel); }, name, "0.25");
  page.pixels = bytes<std::uint16_t>({0, 0x3c00}); // 0, 1
  EXPECT_EQ(read(file("mask.tif", RawFiles::tiff({page})), voxel).data, (std::vector<std::uint16_t>{0, 1}));
  page.bits   = 32;
  page.pixels = bytes<float>({7, 300});
  EXPECT_EQ(read(file("single.tif", RawFiles::tiff({page})), voxel).data, (std::vector<std::uint16_t>{7, 300}));
}

TEST_F(ImageTiff, WholeNumbersOfAllWidths)
{
  RawFiles::TiffPage page;
  page.bits   = 32;
  page.format = 2;
  page.pixels = bytes<std::int32_t>({7, 300});
  EXPECT_EQ(read(file("a.tif", RawFiles::tiff({page})), voxel).data, (std::vector<std::uint16_t>{7, 300}));
  page.pixels = bytes<std::int32_t>({7, -1});
  expect_user_error([&] { read(file("b.tif", RawFiles::tiff({page})), voxel); }, "negative");
  page.bits   = 12;
  page.format = 1;
  expect_user_error([&] { read(file("c.tif", RawFiles::tiff({page})), voxel); }, "12 bits");
  page.bits   = 32;
  page.format = 5;
  expect_user_error([&] { read(file("d.tif", RawFiles::tiff({page})), voxel); }, "complex");
}

TEST_F(ImageTiff, Tiles)
{
  RawFiles::TiffPage page;
  page.tiled  = true;
  page.width  = 3;
  page.height = 2;
  page.pixels = std::string(256, '\x7f');
  for (unsigned int y = 0; y < 2; ++y)
    for (unsigned int x = 0; x < 3; ++x)
      page.pixels[16 * y + x] = static_cast<char>(10 * y + x);
  EXPECT_EQ(read(file("a.TIF", RawFiles::tiff({page})), voxel).data, (std::vector<std::uint16_t>{0, 1, 2, 10, 11, 12}));
}

TEST_F(ImageTiff, ImageJHyperstacks)
{
  const auto name = file("a.tif",
                         RawFiles::tiff(
                           pages(12, "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n")));
  expect_user_error([&] { slices(name, 0, 0); }, name, "2 channels", "'Channel'");
  expect_user_error([&] { slices(name, 1, 0); }, name, "2 frames", "'Frame'");
  EXPECT_EQ(slices(name, 1, 1), (Numbers{0, 2, 4}));
  EXPECT_EQ(slices(name, 2, 1), (Numbers{1, 3, 5}));
  EXPECT_EQ(slices(name, 2, 2), (Numbers{7, 9, 11}));
  EXPECT_EQ(slices(file("b.tif", RawFiles::tiff(pages(3, "ImageJ=1.53t\nimages=3\nslices=3\n"))), 0, 0),
            (Numbers{0, 1, 2}));
  EXPECT_EQ(slices(file("c.tif", RawFiles::tiff(pages(3, "ImageJ=1.53t\nunit=um\nimages=3\n"))), 0, 0),
            (Numbers{0, 1, 2}));
  expect_user_error(
    [&] { slices(file("d.tif", RawFiles::tiff(pages(3, "ImageJ=1.53t\nimages=4\nslices=4\n"))), 0, 0); }, "3 pages",
    "4 images");
}

TEST_F(ImageTiff, ImageJStackWithOneDirectory)
{
  // Pixels of the first slice are the last thing in the file: the others follow.
  auto page         = pages(1, "ImageJ=1.53t\nimages=3\nslices=3\n")[0];
  page.pixels       = std::string("\0\0\1\1\2\2", 6);
  std::string file_ = RawFiles::tiff({page});
  const auto  count = file_.find(bytes<std::uint16_t>(279));
  file_.replace(count + 8, 4, bytes<std::uint32_t>(2)); // bytes of the first slice only
  EXPECT_EQ(slices(file("a.tif", file_), 0, 0), (Numbers{0, 1, 2}));
  auto short_one = pages(1, "ImageJ=1.53t\nimages=900\nslices=900\n")[0];
  expect_user_error([&] { slices(file("b.tif", RawFiles::tiff({short_one})), 0, 0); }, path("b.tif"),
                    "more slices than the file holds");
}

TEST_F(ImageTiff, OmeOrderIsHonoured)
{
  const std::string sizes = "SizeX=\"2\" SizeY=\"1\" SizeZ=\"2\" SizeC=\"2\" SizeT=\"1\"";
  const auto        zct   = file("a.tif", RawFiles::tiff(pages(4, ome("XYZCT", sizes, "<TiffData/>"))));
  const auto        czt   = file("b.tif", RawFiles::tiff(pages(4, ome("XYCZT", sizes, ""))));
  expect_user_error([&] { slices(zct, 0, 0); }, zct, "2 channels");
  EXPECT_EQ(slices(zct, 2, 0), (Numbers{2, 3}));
  EXPECT_EQ(slices(czt, 2, 0), (Numbers{1, 3}));
  std::string blocks;
  for (unsigned int i = 0; i < 4; ++i) // pages in reverse order of the planes
    blocks += "<TiffData IFD=\"" + std::to_string(3 - i) + "\" FirstZ=\"" + std::to_string(i % 2) + "\" FirstC=\"" +
              std::to_string(i / 2) + "\" FirstT=\"0\" PlaneCount=\"1\"/>";
  EXPECT_EQ(slices(file("c.tif", RawFiles::tiff(pages(4, ome("XYZCT", sizes, blocks)))), 1, 0), (Numbers{3, 2}));
  expect_user_error([&] { slices(file("d.tif", RawFiles::tiff(pages(3, ome("XYZCT", sizes, "")))), 1, 0); }, "3 pages",
                    "2 channels");
  expect_user_error([&] { slices(file("e.tif", RawFiles::tiff(pages(3, "<OME><Image><Pixels"))), 1, 0); }, "OME XML");
}

TEST_F(ImageTiff, ArraysOfPagesAreRefused)
{
  EXPECT_EQ(slices(file("a.tif", RawFiles::tiff(pages(3, "{\"shape\": [3, 1, 2]}"))), 0, 0), (Numbers{0, 1, 2}));
  expect_user_error([&] { slices(file("b.tif", RawFiles::tiff(pages(6, "{\"shape\": [3, 2, 1, 2]}"))), 0, 0); },
                    "3 x 2 x 1 x 2");
}
