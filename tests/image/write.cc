#include <stroma/image/read.h>
#include <stroma/image/write.h>

#include "read_options.h"
#include "temporary_folder.h"

#include <csignal>
#include <cstdint>
#include <sys/resource.h>

using namespace Stroma::Image;

namespace
{
  using WriteImage = TemporaryFolder;

  const std::array<double, 3> voxel_size = {{0.621e-6, 0.5e-6, 5e-6}};

  template <typename T>
  Volume<T>
  pattern(const std::array<unsigned int, 3> &size)
  {
    Volume<T> volume{size, voxel_size, {{0, 0, 0}}, {}};
    for (unsigned int i = 0; i < volume.n_voxels(); ++i)
      volume.data.push_back(T(i * 2654435761u >> 16));
    return volume;
  }

  template <typename T>
  void
  expect_round_trip(const std::string &name, const Volume<T> &volume)
  {
    write(name, volume);
    const bool is_tiff = name.find(".tif") != std::string::npos;
    const auto copy    = read(name, is_tiff ? with_voxels(voxel_size) : ReadOptions());
    EXPECT_EQ(copy.size, volume.size) << name;
    EXPECT_EQ(copy.data, std::vector<std::uint16_t>(volume.data.begin(), volume.data.end())) << name;
    for (unsigned int d = 0; d < 3; ++d)
      EXPECT_NEAR(copy.voxel_size[d], volume.voxel_size[d], 1e-18) << name;
  }

  /// Limits the size of the files this process can write while it lives, as a full disk does.
  class FullDisk
  {
  public:
    explicit FullDisk(const rlim_t n_bytes)
    {
      getrlimit(RLIMIT_FSIZE, &saved);
      handler            = std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit = {n_bytes, saved.rlim_max};
      setrlimit(RLIMIT_FSIZE, &limit);
    }

    ~FullDisk()
    {
      setrlimit(RLIMIT_FSIZE, &saved);
      std::signal(SIGXFSZ, handler);
    }

  private:
    rlimit saved;
    void (*handler)(int);
  };
} // namespace

TEST_F(WriteImage, RoundTrips)
{
  for (const std::string extension : {".nrrd", ".mha", ".tif", ".tiff"})
    {
      expect_round_trip(path("a" + extension), pattern<std::uint8_t>({{7, 5, 3}}));
      expect_round_trip(path("b" + extension), pattern<std::uint16_t>({{7, 5, 3}}));
      expect_round_trip(path("c" + extension), pattern<std::uint8_t>({{7, 5, 1}}));
    }
}

TEST_F(WriteImage, NrrdSaysPlaceAndUnits)
{
  auto volume   = pattern<std::uint8_t>({{64, 64, 4}});
  volume.origin = {{10e-6, 0, 0}};
  std::fill(volume.data.begin(), volume.data.end(), 7);
  write(path("a.nrrd"), volume);
  const std::string text = content(path("a.nrrd"));
  EXPECT_NE(text.find("space units: \"um\" \"um\" \"um\"\n"), std::string::npos);
  EXPECT_NE(text.find("space directions: (0.621"), std::string::npos);
  EXPECT_NE(text.find("space origin: (10.31"), std::string::npos);
  EXPECT_LT(text.size(), 1000u) << "16384 equal voxels are compressed";
  write(path("a.nrrd"), volume, true, "right-anterior-superior");
  EXPECT_NE(content(path("a.nrrd")).find("\nspace: right-anterior-superior\n"), std::string::npos);
  EXPECT_EQ(read(path("a.nrrd")).frame.space, "right-anterior-superior");
}

TEST_F(WriteImage, KeepsAnExistingFile)
{
  file("a.nrrd", "precious");
  const auto volume = pattern<std::uint8_t>({{2, 2, 2}});
  expect_user_error([&] { write(path("a.nrrd"), volume); }, path("a.nrrd"), "exists");
  EXPECT_EQ(content(path("a.nrrd")), "precious");
  write(path("a.nrrd"), volume, true);
  EXPECT_EQ(read(path("a.nrrd")).n_voxels(), 8u);
}

TEST_F(WriteImage, RefusesOtherFormatsAndMissingFolders)
{
  const auto volume = pattern<std::uint8_t>({{2, 2, 2}});
  expect_user_error([&] { write(path("a.png"), volume); }, path("a.png"), ".nrrd");
  expect_user_error([&] { write(path("a.nii"), volume); }, path("a.nii"), ".nrrd");
  expect_user_error([&] { write(path("none/a.nrrd"), volume); }, path("none/a.nrrd"), "does not exist");
}

TEST_F(WriteImage, FullDiskLeavesTheOldFile)
{
  const auto volume = pattern<std::uint16_t>({{64, 64, 8}});
  for (const std::string extension : {".nrrd", ".mha", ".tif"})
    {
      file("a" + extension, "precious");
      {
        const FullDisk disk(5000);
        expect_user_error([&] { write(path("a" + extension), volume, true); }, path("a" + extension), "disk");
      }
      EXPECT_EQ(content(path("a" + extension)), "precious");
    }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 3) << "temporary files are left";
}

TEST_F(WriteImage, CompressedFilesCutOffOrDamagedAreRefused)
{
  for (const std::string extension : {".nrrd", ".mha"})
    {
      write(path("a" + extension), pattern<std::uint16_t>({{20, 20, 3}}));
      const std::string whole = content(path("a" + extension));
      for (std::size_t length = 0; length + 10 < whole.size(); length += 17)
        expect_user_error([&] { read(file("cut" + extension, whole.substr(0, length))); }, path("cut" + extension));
      std::string damaged = whole;
      damaged[whole.size() - 200] ^= 0x55;
      expect_user_error([&] { read(file("damaged" + extension, damaged)); }, path("damaged" + extension));
    }
}
