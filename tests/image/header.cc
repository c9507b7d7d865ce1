// What a file's header says is what is read, or it is refused: units, spacing, axes, scaling, frames.

#include <stroma/image/read.h>

#include "raw_files.h"
#include "read_options.h"
#include "temporary_folder.h"

#include <limits>

using namespace Stroma::Image;
using RawFiles::bytes;

namespace
{
  using ImageHeader = TemporaryFolder;

  const std::vector<std::uint16_t> values = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const std::string                voxels = bytes(values);

  void
  expect_edges(const std::string &name, const std::array<double, 3> &edges, const ReadOptions &options = ReadOptions())
  {
    const auto volume = read(name, options);
    for (unsigned int d = 0; d < 3; ++d)
      EXPECT_NEAR(volume.voxel_size[d], edges[d], 1e-6 * edges[d]) << name;
  }

  std::string
  nrrd_in(const std::string &unit, const std::string &spacing)
  {
    const std::string quoted = "\"" + unit + "\"";
    return RawFiles::nrrd("uint16", "2 3 2", "", voxels,
                          "space dimension: 3\nspace directions: (" + spacing + ",0,0) (0," + spacing + ",0) (0,0," +
                            spacing + ")\nspace units: " + quoted + " " + quoted + " " + quoted + "\n");
  }

  RawFiles::Nifti
  nifti_in(const int unit, const float spacing)
  {
    RawFiles::Nifti header;
    header.size    = {2, 3, 2};
    header.spacing = {spacing, spacing, spacing};
    header.unit    = unit;
    return header;
  }
} // namespace

TEST_F(ImageHeader, UnitsOfLengthAreUsed)
{
  const std::array<double, 3> two_um = {{2e-6, 2e-6, 2e-6}};
  expect_edges(file("um.nii", RawFiles::nifti(nifti_in(3, 2), voxels)), two_um);
  expect_edges(file("mm.nii", RawFiles::nifti(nifti_in(2, .002f), voxels)), two_um);
  expect_edges(file("m.nii", RawFiles::nifti(nifti_in(1, 2e-6f), voxels)), two_um);
  expect_edges(file("none.nii", RawFiles::nifti(nifti_in(0, 2), voxels)), two_um);
  expect_edges(file("two.nii", RawFiles::nifti(nifti_in(3, 2), voxels, 2)), two_um);
  expect_edges(file("um.nrrd", nrrd_in("um", "2")), two_um);
  expect_edges(file("microns.nrrd", nrrd_in("microns", "2")), two_um);
  expect_edges(file("mm.nrrd", nrrd_in("mm", "0.002")), two_um);
  expect_edges(file("units.nrrd", RawFiles::nrrd("uint16", "2 3 2", "2 2 2", voxels, "units: \"um\" \"um\" \"um\"\n")),
               two_um);
  expect_edges(file("um.mha", RawFiles::metaimage("MET_USHORT", "2 3 2", "2 2 2", voxels, "DistanceUnits = um\n")),
               two_um);
  expect_edges(file("none.mha", RawFiles::metaimage("MET_USHORT", "2 3 2", "2 2 2", voxels)), two_um, with_unit(1e-6));
}

TEST_F(ImageHeader, UnitsThatContradictAreRefused)
{
  expect_user_error([&] { read(file("a.nii", RawFiles::nifti(nifti_in(3, 2), voxels)), with_unit(1e-3)); }, "in um",
                    "'Spacing unit'");
  expect_user_error([&] { read(file("a.nrrd", nrrd_in("mm", "2")), with_unit(1e-6)); }, "in mm");
  expect_user_error([&] { read(file("b.nrrd", nrrd_in("pixel", "2"))); }, "'pixel'", "\"Voxel size\"");
  expect_user_error([&] { read(file("a.mha", RawFiles::metaimage("MET_USHORT", "2 3 2", "2 2 2", voxels))); },
                    "'Spacing unit'");
  expect_edges(file("a.nii", RawFiles::nifti(nifti_in(3, 2), voxels)), {{2e-6, 2e-6, 2e-6}}, with_unit(1e-6));
}

TEST_F(ImageHeader, MissingSpacingIsRefused)
{
  for (const std::string &name : {file("a.nrrd", RawFiles::nrrd("uint16", "2 3 2", "", voxels)),
                                  file("a.mha", RawFiles::metaimage("MET_USHORT", "2 3 2", "", voxels)),
                                  file("a.nii", RawFiles::nifti(nifti_in(3, 0), voxels)),
                                  file("b.nrrd", RawFiles::nrrd("uint16", "4 3", "1 1", voxels))})
    {
      expect_user_error([&, &n = name] { read(n); }, name, "\"Voxel size\"");
      EXPECT_EQ(read(name, with_voxels({{1e-6, 1e-6, 2e-6}})).data, values);
    }
}

TEST_F(ImageHeader, AxesOfTheHeaderAreXYZ)
{
  // The first stored axis runs along z, the second along y downwards, the third along x.
  RawFiles::Nifti turned = nifti_in(3, 1);
  turned.spacing         = {4, 5, 6};
  turned.sform           = {0, 0, 6, 0, 0, -5, 0, 0, 4, 0, 0, 0};
  const std::string direction =
    "space: left-posterior-superior\nspace directions: (0,0,4) (0,-5,0) (6,0,0)\nspace units: \"um\" \"um\" \"um\"\n";
  for (const std::string &name :
       {file("a.nii", RawFiles::nifti(turned, voxels)), file("b.nii", RawFiles::nifti(turned, voxels, 2)),
        file("a.nrrd", RawFiles::nrrd("uint16", "2 3 2", "", voxels, direction)),
        file("a.mha", RawFiles::metaimage("MET_USHORT", "2 3 2", "4 5 6", voxels,
                                          "DistanceUnits = um\nTransformMatrix = 0 0 1 0 -1 0 1 0 0\n"))})
    {
      const auto volume = read(name);
      EXPECT_EQ(volume.size, (std::array<unsigned int, 3>{{2, 3, 2}})) << name;
      expect_edges(name, {{6e-6, 5e-6, 4e-6}});
      for (unsigned int k = 0; k < 2; ++k)
        for (unsigned int j = 0; j < 3; ++j)
          for (unsigned int i = 0; i < 2; ++i)
            EXPECT_EQ(volume.at(k, 2 - j, i), values[i + 2 * (j + 3 * k)]) << name;
      ReadOptions stored;
      stored.stored_axes = true;
      EXPECT_EQ(read(name, stored).data, values) << name;
      EXPECT_DOUBLE_EQ(read(name, stored).voxel_size[0], 4e-6) << name;
    }
}

TEST_F(ImageHeader, ObliqueAndShearedAxesAreRefused)
{
  ReadOptions stored;
  stored.stored_axes      = true;
  RawFiles::Nifti oblique = nifti_in(3, 1), sheared = oblique, wrong = oblique;
  oblique.sform   = {.8f, -.6f, 0, 0, .6f, .8f, 0, 0, 0, 0, 1, 0};
  sheared.sform   = {1, 0, 0, 0, 0, .9887f, 0, 0, 0, .15f, 1, 0};
  wrong.sform     = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0};
  const auto name = file("a.nii", RawFiles::nifti(oblique, voxels));
  expect_user_error([&] { read(name); }, name, "oblique", "36.8699 degrees", "'Axes = stored'");
  EXPECT_EQ(read(name, stored).data, values);
  expect_user_error([&] { read(file("b.nii", RawFiles::nifti(sheared, voxels))); }, "sheared");
  expect_user_error([&] { read(file("b.nii", RawFiles::nifti(sheared, voxels)), stored); }, "sheared");
  expect_user_error([&] { read(file("c.nii", RawFiles::nifti(wrong, voxels))); }, "2 apart by the sform",
                    "1 by pixdim");
}

TEST_F(ImageHeader, ScalingIsApplied)
{
  RawFiles::Nifti header = nifti_in(3, 1);
  header.slope           = 2;
  header.intercept       = 1;
  EXPECT_EQ(read(file("a.nii", RawFiles::nifti(header, voxels))).data,
            (std::vector<std::uint16_t>{1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23}));
  header.slope     = .1f; // not exact in binary
  header.intercept = 0;
  const std::vector<std::uint16_t> tens(12, 70);
  EXPECT_EQ(read(file("b.nii", RawFiles::nifti(header, bytes(tens)))).data, std::vector<std::uint16_t>(12, 7));
  header.intercept = -1024;
  header.slope     = 1;
  expect_user_error([&] { read(file("c.nii", RawFiles::nifti(header, voxels))); }, "-1024", "negative");
  EXPECT_FLOAT_EQ(read<float>(path("c.nii")).data[5], -1019);
}

TEST_F(ImageHeader, FramesAndChannelsAreChosen)
{
  RawFiles::Nifti header = nifti_in(3, 1);
  header.size            = {2, 3, 1, 2};
  const auto  nifti      = file("a.nii", RawFiles::nifti(header, voxels));
  const auto  nrrd       = file("a.nrrd", RawFiles::nrrd("uint16", "2 3 1 2", "1 1 1 1", voxels));
  std::string meta       = RawFiles::metaimage("MET_USHORT", "2 3 1 2", "1 1 1 1", voxels, "DistanceUnits = um\n");
  meta.replace(meta.find("NDims = 3"), 9, "NDims = 4");
  for (const std::string &name : {nifti, nrrd, file("a.mha", meta)})
    {
      expect_user_error([&, &n = name] { read(n); }, name, "2 frames", "'Frame'");
      ReadOptions second;
      second.frame = 2;
      EXPECT_EQ(read(name, second).data, (std::vector<std::uint16_t>{6, 7, 8, 9, 10, 11})) << name;
      second.frame = 3;
      expect_user_error([&, &n = name] { read(n, second); }, name, "was given as 3");
    }
}

TEST_F(ImageHeader, WrongSizesAreRefused)
{
  expect_user_error([&] { read(file("a.nrrd", RawFiles::nrrd("uint16", "2 3 1.5", "1 1 1", voxels))); },
                    "whole numbers");
  expect_user_error([&] { read(file("a.mha", RawFiles::metaimage("MET_USHORT", "2 3 1.5", "1 1 1", voxels))); },
                    "whole");
  expect_user_error([&] { read(file("b.mha", RawFiles::metaimage("MET_USHORT", "2 3 1 2", "1 1 1", voxels))); },
                    "DimSize");
  const std::string text = "encoding: text\n";
  expect_user_error([&] { read(file("b.nrrd", RawFiles::nrrd("uint16", "3 1 1", "1 1 1", "1 2 31", text))); },
                    "cut off");
  expect_user_error([&] { read(file("c.nrrd", RawFiles::nrrd("uint16", "3 1 1", "1 1 1", "1 2\n", text))); },
                    path("c.nrrd"));
  EXPECT_EQ(read(file("d.nrrd", RawFiles::nrrd("uint16", "3 1 1", "1 1 1", "1 2 31\n", text))).data[2], 31);
}

TEST_F(ImageHeader, VoxelsBesideTheHeader)
{
  file("voxels.raw", voxels);
  EXPECT_EQ(read(file("a.mhd", RawFiles::metaimage("MET_USHORT", "2 3 2", "1 1 1", "", "", "voxels.raw")),
                 with_unit(1e-6))
              .data,
            values);
  EXPECT_EQ(
    read(file("a.nhdr", RawFiles::nrrd("uint16", "2 3 2", "1 1 1", "", "data file: voxels.raw\nencoding: raw\n"))).data,
    values);
  expect_user_error(
    [&] {
      read(file("b.mhd", RawFiles::metaimage("MET_USHORT", "2 3 3", "1 1 1", "", "", "voxels.raw")), with_unit(1e-6));
    },
    "cut off");
  expect_user_error(
    [&] {
      read(file("c.mhd", RawFiles::metaimage("MET_USHORT", "2 3 2", "1 1 1", "", "", "none.raw")), with_unit(1e-6));
    },
    "does not exist");
}

TEST_F(ImageHeader, CapitalExtensions)
{
  EXPECT_EQ(read(file("A.NRRD", RawFiles::nrrd("uint16", "2 3 2", "1 1 1", voxels))).data, values);
  EXPECT_EQ(read(file("A.Nii", RawFiles::nifti(nifti_in(3, 1), voxels))).data, values);
}

TEST_F(ImageHeader, AllNumberTypes)
{
  const auto expect = [&](const std::string &type, const std::string &data) {
    EXPECT_EQ(read(file("a.nrrd", RawFiles::nrrd(type, "3 1 1", "1 1 1", data))).data,
              (std::vector<std::uint16_t>{0, 1, 300}))
      << type;
  };
  expect("int32", bytes<std::int32_t>({0, 1, 300}));
  expect("uint32", bytes<std::uint32_t>({0, 1, 300}));
  expect("int64", bytes<std::int64_t>({0, 1, 300}));
  expect("float", bytes<float>({0, 1, 300}));
  expect("double", bytes<double>({0, 1, 300}));
  const auto wrong = file("b.nrrd", RawFiles::nrrd("int32", "3 1 1", "1 1 1", bytes<std::int32_t>({0, 1, 70000})));
  expect_user_error([&] { read(wrong); }, wrong, "voxel 2, 0, 0", "70000", "65535");
  const auto grey = file("c.nrrd", RawFiles::nrrd("float", "3 1 1", "1 1 1", bytes<float>({-.5, .25, 1e6})));
  expect_user_error([&] { read(grey); }, grey, "-0.5");
  EXPECT_EQ(read<float>(grey).data, (std::vector<float>{-.5, .25, 1e6}));
  const auto nan = file("d.nrrd", RawFiles::nrrd("float", "1 1 1", "1 1 1",
                                                 bytes<float>(std::numeric_limits<float>::quiet_NaN())));
  expect_user_error([&] { read<float>(nan); }, nan, "finite");
}
