#include <stroma/base/node_copy.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>

namespace
{
  namespace mpi = dealii::Utilities::MPI;
}

TEST(NodeCopy, MpiAllRanksReadTheBytesOfTheFirst)
{
  const bool                is_first = mpi::this_mpi_process(MPI_COMM_WORLD) == 0;
  std::vector<std::uint8_t> bytes(is_first ? 100000 : 0);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = i % 251;
  const auto copy = Stroma::one_copy_a_node(bytes, MPI_COMM_WORLD);
  for (std::size_t i = 0; i < 100000; ++i)
    ASSERT_EQ(copy.get()[i], i % 251);
}

TEST(NodeCopy, MpiThereIsOneCopyANode)
{
  MPI_Comm node; // what the first rank of a node writes the others see
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  const auto copy = Stroma::one_copy_a_node({1, 2, 3}, MPI_COMM_WORLD);
  if (mpi::this_mpi_process(node) == 0)
    const_cast<std::uint8_t *>(copy.get())[1] = 7;
  MPI_Barrier(node);
  EXPECT_EQ(copy.get()[1], 7);
  MPI_Comm_free(&node);
  for (const auto &left : std::filesystem::directory_iterator("/dev/shm")) // a name would outlive the program
    EXPECT_NE(left.path().filename().string().rfind("stroma-" + std::to_string(getpid()) + "-", 0), 0u);
}

TEST(NodeCopy, MpiEachRankLetsGoAlone)
{
  auto copy = Stroma::one_copy_a_node({4, 5}, MPI_COMM_WORLD);
  if (mpi::this_mpi_process(MPI_COMM_WORLD) == 0)
    copy.reset(); // waits for nobody, and the others keep theirs
  MPI_Barrier(MPI_COMM_WORLD);
  if (copy)
    {
      EXPECT_EQ(copy.get()[1], 5);
    }
  EXPECT_NO_THROW(Stroma::one_copy_a_node({}, MPI_COMM_WORLD));
}
