#include <stroma/image/read.h>

#include "raw_files.h"
#include "read_options.h"
#include "temporary_folder.h"

using namespace Stroma::Image;
using RawFiles::bytes;

namespace
{
  using ReadImage = TemporaryFolder;

  const ReadOptions                micrometre       = with_voxels({{1e-6, 1e-6, 1e-6}});
  const std::vector<std::uint16_t> numbers          = {0, 1, 255, 256, 40000, 65535, 7, 8, 9, 10, 11, 12};
  const std::string                numbers_in_bytes = bytes(numbers);

  RawFiles::TiffPage
  page16(const std::vector<std::uint16_t> &pixels)
  {
    RawFiles::TiffPage page;
    page.width  = 2;
    page.height = 3;
    page.bits   = 16;
    page.pixels = bytes(pixels);
    return page;
  }

  std::string
  stack16()
  {
    return RawFiles::tiff(
      {page16({numbers.begin(), numbers.begin() + 6}), page16({numbers.begin() + 6, numbers.end()})});
  }
} // namespace

TEST_F(ReadImage, OrdersVoxelsAndScalesSpacing)
{
  for (const std::string &name :
       {file("a.nrrd", RawFiles::nrrd("uint16", "2 3 2", "0.5 2 4", numbers_in_bytes)),
        file("a.mha", RawFiles::metaimage("MET_USHORT", "2 3 2", "0.5 2 4", numbers_in_bytes)),
        file("a.nii", RawFiles::nifti({{2, 3, 2}, {0.5, 2, 4}}, numbers_in_bytes))})
    {
      const auto volume = read(name, with_unit(1e-3));
      EXPECT_EQ(volume.size, (std::array<unsigned int, 3>{{2, 3, 2}})) << name;
      EXPECT_EQ(volume.data, numbers) << name;
      EXPECT_EQ(volume.at(1, 2, 0), 65535) << name;
      EXPECT_EQ(volume.at(0, 1, 1), 9) << name;
      EXPECT_DOUBLE_EQ(volume.voxel_size[0], 0.5e-3) << name;
      EXPECT_DOUBLE_EQ(volume.voxel_size[1], 2e-3) << name;
      EXPECT_DOUBLE_EQ(volume.voxel_size[2], 4e-3) << name;
      EXPECT_EQ(volume.origin, (std::array<double, 3>{{0, 0, 0}})) << name;
    }
}

TEST_F(ReadImage, GivenVoxelSizeWins)
{
  const auto volume = read(file("a.nrrd", RawFiles::nrrd("uint16", "2 3 2", "1 1 1", numbers_in_bytes)),
                           with_voxels({{1e-6, 2e-6, 5e-6}}));
  EXPECT_EQ(volume.voxel_size, (std::array<double, 3>{{1e-6, 2e-6, 5e-6}}));
}

TEST_F(ReadImage, SixteenBitTiffStack)
{
  const auto volume = read(file("a.tif", stack16()), micrometre);
  EXPECT_EQ(volume.size, (std::array<unsigned int, 3>{{2, 3, 2}}));
  EXPECT_EQ(volume.data, numbers);
}

TEST_F(ReadImage, TiffNeedsAVoxelSize)
{
  expect_user_error([&] { read(file("a.tif", stack16())); }, path("a.tif"), "\"Voxel size\"");
}

TEST_F(ReadImage, EightBitTypes)
{
  EXPECT_EQ(read(file("a.nrrd", RawFiles::nrrd("uint8", "2 2 1", "1 1 1", "\x01\x02\xc8\xff"))).data,
            (std::vector<std::uint16_t>{1, 2, 200, 255}));
  EXPECT_EQ(read(file("b.nrrd", RawFiles::nrrd("int8", "2 2 1", "1 1 1", "\x01\x02\x03\x7f"))).data,
            (std::vector<std::uint16_t>{1, 2, 3, 127}));
}

TEST_F(ReadImage, TwoDimensions)
{
  ReadOptions plane;
  plane.plane      = true;
  const auto slice = read(file("a.nrrd", RawFiles::nrrd("uint16", "4 3", "2 2", numbers_in_bytes)), plane);
  EXPECT_EQ(slice.size, (std::array<unsigned int, 3>{{4, 3, 1}}));
  EXPECT_DOUBLE_EQ(slice.voxel_size[1], 2e-6);
  EXPECT_EQ(slice.data, numbers);
  const auto page = read(file("a.tif", RawFiles::tiff({page16({1, 2, 3, 4, 5, 6})})), micrometre);
  EXPECT_EQ(page.size, (std::array<unsigned int, 3>{{2, 3, 1}}));
  EXPECT_EQ(page.data, (std::vector<std::uint16_t>{1, 2, 3, 4, 5, 6}));
}

TEST_F(ReadImage, RefusesNegativeValues)
{
  const auto name = file("a.nrrd", RawFiles::nrrd("int16", "2 1 1", "1 1 1", bytes<std::int16_t>({5, -1})));
  expect_user_error([&] { read(name); }, name, "negative");
  const auto fine = file("b.nrrd", RawFiles::nrrd("int16", "2 1 1", "1 1 1", bytes<std::int16_t>({5, 32767})));
  EXPECT_EQ(read(fine).data, (std::vector<std::uint16_t>{5, 32767}));
}

TEST_F(ReadImage, RefusesColours)
{
  RawFiles::TiffPage page;
  page.samples     = 3;
  page.photometric = 2;
  page.pixels      = std::string(6, '\1');
  expect_user_error([&] { read(file("a.tif", RawFiles::tiff({page})), micrometre); }, path("a.tif"), "colours (3");
  std::string coloured = RawFiles::nrrd("uint8", "3 2 2 2", "nan 1 1 1", std::string(24, '\1'));
  coloured.insert(coloured.find("endian"), "kinds: RGB-color domain domain domain\n");
  expect_user_error([&] { read(file("a.nrrd", coloured)); }, path("a.nrrd"), "3 components");
}

TEST_F(ReadImage, RefusesTiffsThatWouldBeMisread)
{
  const auto expect = [&](const std::vector<RawFiles::TiffPage> &pages, const std::string &reason) {
    expect_user_error([&] { read(file("a.tif", RawFiles::tiff(pages)), micrometre); }, path("a.tif"), reason);
  };
  RawFiles::TiffPage turned, four_bits, wide, preview;
  turned.orientation   = 4;
  four_bits.bits       = 4;
  wide.width           = 200;
  wide.pixels          = std::string(200, '\1');
  preview.subfile_type = 1;
  expect({turned}, "upper left corner");
  expect({four_bits}, "4 bits");
  expect({RawFiles::TiffPage(), wide}, "page 2 has 200 x 1");
  expect({RawFiles::TiffPage(), preview}, "reduced copies");
}

TEST_F(ReadImage, RefusesATiffWhosePagesGoRound)
{
  std::string stack = RawFiles::tiff({RawFiles::TiffPage()});
  stack.replace(stack.size() - 4, 4, stack.substr(4, 4));
  expect_user_error([&] { read(file("a.tif", stack), micrometre); }, path("a.tif"), "damaged");
}

TEST_F(ReadImage, RefusesWhatIsNoImage)
{
  expect_user_error([&] { read(path("none.nrrd")); }, path("none.nrrd"), "no such");
  expect_user_error([&] { read(folder.string()); }, folder.string(), "no readable file");
  expect_user_error([&] { read(file("a.png", "x")); }, path("a.png"), ".nrrd", ".nii.gz");
  for (const std::string name : {"a.tif", "a.nrrd", "a.mha", "a.nii", "a.nii.gz"})
    for (const std::string &text : {std::string(), std::string("x"), std::string(5000, 'x')})
      expect_user_error([&] { read(file(name, text), micrometre); }, path(name));
}

TEST_F(ReadImage, RefusesVoxelSizesThatAreNotPositive)
{
  const auto name = file("a.nrrd", RawFiles::nrrd("uint16", "2 3 2", "1 1 1", numbers_in_bytes));
  expect_user_error([&] { read(name, with_voxels({{1e-6, 0, 1e-6}})); }, name, "along y", "\"Voxel size\"");
  expect_user_error([&] { read(name, with_unit(-1)); }, name, "axis 1");
}

TEST_F(ReadImage, RefusesFilesCutOffAnywhere)
{
  const std::string files[][2] = {{"nrrd", RawFiles::nrrd("uint16", "2 3 2", "1 1 1", numbers_in_bytes)},
                                  {"mha", RawFiles::metaimage("MET_USHORT", "2 3 2", "1 1 1", numbers_in_bytes)},
                                  {"nii", RawFiles::nifti({{2, 3, 2}, {1, 1, 1}}, numbers_in_bytes)},
                                  {"tif", stack16()}};
  for (const auto &[extension, whole] : files)
    {
      EXPECT_EQ(read(file("a." + extension, whole), micrometre).data, numbers);
      for (std::size_t length = 0; length < whole.size(); ++length)
        expect_user_error([&, &e = extension, &w = whole] { read(file("cut." + e, w.substr(0, length)), micrometre); },
                          path("cut." + extension));
    }
}

TEST_F(ReadImage, SaysNothingOnStandardError)
{
  testing::internal::CaptureStderr();
  const std::string metaimage = RawFiles::metaimage("MET_USHORT", "2 3 2", "1 1 1", numbers_in_bytes);
  user_error([&] { read(file("a.mha", metaimage.substr(0, 100))); });
  user_error([&] { read(file("a.nii", "x")); });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}
