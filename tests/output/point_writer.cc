#include "../world.h"
#include "temporary_folder.h"
#include "vtu_reader.h"

#include <stroma/base/output_error.h>
#include <stroma/output/hdf5_array.h>
#include <stroma/output/point_writer.h>

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>

using namespace Stroma;
using namespace Stroma::Output;

namespace
{
  const std::vector<Field> fields = {{"von_mises_Pa", 1}, {"displacement_m", 3}, {"stress_Pa", 6}, {"F", 9}};

  /// Component c of all fields (19 in all) at point i.
  double
  value(const std::size_t i, const unsigned int c)
  {
    return 1e4 * std::sin(0.37 * i) + c;
  }

  template <int dim>
  std::string
  write_points(const std::string &folder, const std::size_t n, const Format format)
  {
    PointWriter<dim>    writer(folder, "points", 7, fields, world, format);
    std::vector<double> values(19);
    for (std::size_t i = 0; i < n; ++i)
      {
        dealii::Point<dim> x;
        for (unsigned int d = 0; d < dim; ++d)
          x[d] = 1e-5 * i + d + 10 * my_rank();
        for (unsigned int c = 0; c < 19; ++c)
          values[c] = value(i, c);
        writer.add(x, dealii::make_array_view(values));
      }
    return writer.close();
  }

  std::size_t
  occurrences(const std::string &text, const std::string &word)
  {
    std::size_t n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
      ++n;
    return n;
  }
} // namespace

TEST(PointWriter, MpiVtuRoundTrip)
{
  const TemporaryFolder folder;
  const std::size_t     n = 30000 + 100 * my_rank(); // several blocks an array, the last one partial
  EXPECT_EQ(write_points<3>(folder.path, n, Format::vtu), "points_0007.pvtu");

  const std::string piece = folder / ("points_0007." + std::to_string(my_rank()) + ".0.vtu");
  const auto        x     = read_vtu_array<float>(piece, "Points");
  const auto        mises = read_vtu_array<float>(piece, "von_mises_Pa");
  const auto        tau   = read_vtu_array<float>(piece, "stress_Pa");
  const auto        F     = read_vtu_array<float>(piece, "F");
  ASSERT_EQ(x.size(), 3 * n);
  ASSERT_EQ(mises.size(), n);
  ASSERT_EQ(read_vtu_array<float>(piece, "displacement_m").size(), 3 * n);
  ASSERT_EQ(tau.size(), 6 * n);
  ASSERT_EQ(F.size(), 9 * n);
  for (const std::size_t i : {std::size_t(0), std::size_t(20000), n - 1})
    {
      EXPECT_FLOAT_EQ(x[3 * i + 2], 1e-5 * i + 2 + 10 * my_rank());
      EXPECT_FLOAT_EQ(mises[i], value(i, 0));
      EXPECT_FLOAT_EQ(tau[6 * i + 3], value(i, 4 + 3)); // xy
      EXPECT_FLOAT_EQ(tau[6 * i + 4], value(i, 4 + 5)); // VTK has yz before xz, deal.II 02 before 12
      EXPECT_FLOAT_EQ(tau[6 * i + 5], value(i, 4 + 4));
      EXPECT_FLOAT_EQ(F[9 * i + 8], value(i, 18));
    }
  const auto connectivity = read_vtu_array<std::int32_t>(piece, "connectivity");
  const auto offsets      = read_vtu_array<std::int32_t>(piece, "offsets");
  EXPECT_EQ(connectivity.back(), static_cast<int>(n) - 1);
  EXPECT_EQ(offsets.back(), static_cast<int>(n));
  EXPECT_EQ(read_vtu_array<std::uint8_t>(piece, "types"), std::vector<std::uint8_t>(n, 1));
}

TEST(PointWriter, MpiRecordNamesAllPiecesOfAllRanks)
{
  const TemporaryFolder folder;
  // Rank 0 fills one piece and ten points of a second; the last of several ranks has no point at all.
  const bool        empty = my_rank() > 0 && my_rank() + 1 == n_ranks();
  const std::size_t n     = my_rank() == 0 ? PointWriter<2>::piece_size + 10 : empty ? 0 : 5;
  PointWriter<2>    writer(folder.path, "points", 12, {{"v_m_per_s", 2}}, world);
  for (std::size_t i = 0; i < n; ++i)
    {
      const std::vector<double> v = {1. * i, -2.};
      writer.add(dealii::Point<2>(0.5, 1.5), dealii::make_array_view(v));
    }
  EXPECT_EQ(writer.close(), "points_0012.pvtu");

  const std::string record = read_text(folder / "points_0012.pvtu");
  const std::size_t pieces = 2 + (n_ranks() > 2 ? n_ranks() - 2 : 0);
  EXPECT_EQ(occurrences(record, "<Piece "), pieces);
  for (std::size_t at = record.find("Source=\""); at != std::string::npos; at = record.find("Source=\"", at + 1))
    {
      const std::string name = record.substr(at + 8, record.find('"', at + 8) - at - 8);
      EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
    }
  EXPECT_EQ(read_vtu_array<float>(folder / "points_0012.0.0.vtu", "v_m_per_s").size(), 3 * PointWriter<2>::piece_size);
  const auto rest = read_vtu_array<float>(folder / "points_0012.0.1.vtu", "v_m_per_s");
  ASSERT_EQ(rest.size(), 30u);
  EXPECT_EQ(rest[27], PointWriter<2>::piece_size + 9.f);
  EXPECT_EQ(rest[28], -2.f);
  EXPECT_EQ(rest[29], 0.f); // third component of a two-dimensional vector
}

TEST(PointWriter, MpiXdmfKeepsAllTensorComponents)
{
  const TemporaryFolder folder;
  EXPECT_EQ(write_points<2>(folder.path, 100, Format::xdmf), "points_0007.xdmf");

  const std::string  name = "points_0007." + std::to_string(my_rank()) + ".0.h5";
  const Hdf5Handle   file(H5Fopen((folder / name).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const Hdf5Handle   set(H5Dopen2(file, "stress_Pa", H5P_DEFAULT), H5Dclose);
  std::vector<float> tau(900);
  ASSERT_GE(H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, tau.data()), 0);
  const unsigned int order[] = {0, 3, 4, 3, 1, 5, 4, 5, 2}; // row by row
  for (unsigned int c = 0; c < 9; ++c)
    EXPECT_FLOAT_EQ(tau[9 * 99 + c], value(99, 4 + order[c])) << c;

  const std::string record = read_text(folder / "points_0007.xdmf");
  EXPECT_EQ(occurrences(record, "GridType=\"Uniform\""), n_ranks());
  EXPECT_EQ(occurrences(record, "AttributeType=\"Tensor\""), 2 * n_ranks());
  EXPECT_EQ(occurrences(record, "Dimensions=\"100 9\""), 2 * n_ranks());
  EXPECT_EQ(occurrences(record, name + ":/stress_Pa"), 1u);
}

TEST(PointWriter, MpiFullDiskIsReportedOnAllRanksAndLeavesNothing)
{
  const TemporaryFolder folder;
  rlimit                old;
  getrlimit(RLIMIT_FSIZE, &old);
  const auto   old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small       = {my_rank() == 0 ? 10000 : old.rlim_cur, old.rlim_max};
  for (const Format format : {Format::vtu, Format::xdmf})
    {
      setrlimit(RLIMIT_FSIZE, &small);
      const std::string message = message_of<OutputError>([&] { write_points<3>(folder.path, 3000, format); });
      setrlimit(RLIMIT_FSIZE, &old);
      EXPECT_NE(message.find("points_0007.0.0"), std::string::npos) << message;
      EXPECT_NE(message.find("File too large"), std::string::npos) << message;
      MPI_Barrier(world);
      EXPECT_TRUE(std::filesystem::is_empty(folder.path));
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      MPI_Barrier(world);
    }
  std::signal(SIGXFSZ, old_handler);
}
