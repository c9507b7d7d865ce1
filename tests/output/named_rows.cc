#include "../world.h"
#include "temporary_folder.h"

#include <stroma/output/named_rows.h>

#include <gtest/gtest.h>

using namespace Stroma::Output;

namespace
{
  namespace mpi = dealii::Utilities::MPI;
  /// Names 7, 14, ..., of which every third has two rows; a row is (10 name, 10 name + 1) and counts up in its name.
  struct Rows
  {
    std::vector<std::uint64_t> names;
    std::vector<double>        numbers;

    void
    add(const std::uint64_t name)
    {
      for (unsigned int i = 0; i < (name % 3 == 0 ? 2 : 1); ++i)
        {
          names.push_back(name);
          numbers.insert(numbers.end(), {10. * name + i, 10. * name + i + .5});
        }
    }
  };

  void
  write(const std::string &path, const Rows &rows, const MPI_Comm comm)
  {
    ArchiveWriter archive(path, comm);
    archive.write("names", dealii::make_array_view(rows.names));
    archive.write("rows", dealii::make_array_view(rows.numbers));
    archive.commit();
  }
} // namespace

/// Written by one rank in one order, read by all in another: each gets its names, and one that nobody has is noticed.
TEST(NamedRows, MpiRowsGoToWhoWantsThem)
{
  const TemporaryFolder folder;
  const unsigned int    n = 50, rank = mpi::this_mpi_process(world), n_ranks = mpi::n_mpi_processes(world);
  Rows                  all, mine;
  for (unsigned int i = n; i > 0; --i)
    all.add(7 * i);
  if (rank == 0)
    write(folder / "rows.h5", all, MPI_COMM_SELF);
  MPI_Barrier(world);

  std::vector<std::uint64_t> wanted;
  for (unsigned int i = 1 + rank; i <= n; i += n_ranks)
    {
      wanted.push_back(7 * i);
      mine.add(7 * i);
    }
  const ArchiveReader archive(folder / "rows.h5", world);
  const NamedRows     rows(archive, "names", wanted, world);
  EXPECT_EQ(rows.read("rows", 2), mine.numbers);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_EQ(rows.counts()[i], wanted[i] % 3 == 0 ? 2u : 1u);
  EXPECT_TRUE(rows.has_all());
  EXPECT_EQ(NamedRows(archive, "names", wanted, world, 6).read("rows", 2), mine.numbers); // three rows at once

  const NamedRows few(archive, "names", rank == 0 ? std::vector<std::uint64_t>{7, 8} : std::vector<std::uint64_t>{7},
                      world);
  EXPECT_EQ(few.read("rows", 2), (std::vector<double>{70., 70.5}));
  EXPECT_FALSE(few.has_all()); // nobody has name 8

  const NamedRows twice(archive, "names", {21, 14, 21}, world);
  EXPECT_TRUE(twice.has_all());
  EXPECT_EQ(twice.read_last("rows", 2), (std::vector<double>{211., 211.5, 140., 140.5, 211., 211.5}));
}

/// On the ranks that wrote them they stay where they are.
TEST(NamedRows, MpiOwnRowsComeBackAsTheyAre)
{
  const TemporaryFolder      folder;
  const unsigned int         rank = mpi::this_mpi_process(world), n_ranks = mpi::n_mpi_processes(world);
  Rows                       mine;
  std::vector<std::uint64_t> wanted;
  for (unsigned int i = 20; i > 0; --i)
    {
      wanted.push_back(3 * (i * n_ranks + rank));
      if (i != 5)
        mine.add(wanted.back());
    }
  write(folder / "own.h5", mine, world);
  const ArchiveReader archive(folder / "own.h5", world);
  const NamedRows     rows(archive, "names", wanted, world);
  EXPECT_EQ(rows.read("rows", 2), mine.numbers);
  EXPECT_EQ(rows.counts()[15], 0u);
  EXPECT_EQ(rows.counts()[16], 2u);
}
