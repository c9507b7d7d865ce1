#include "../world.h"
#include "temporary_folder.h"

#include <stroma/base/errors.h>
#include <stroma/base/output_error.h>
#include <stroma/output/archive.h>
#include <stroma/output/checkpoints.h>

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <csignal>
#include <numeric>

using namespace Stroma;
using namespace Stroma::Output;
namespace fs = std::filesystem;

namespace
{
  /// 0 numbers on rank 0, 1000 on rank 1, 2000 on rank 2; on a single rank 500.
  std::vector<double>
  own_block()
  {
    std::vector<double> block(n_ranks() == 1 ? 500 : 1000 * my_rank());
    std::iota(block.begin(), block.end(), 1e6 * my_rank());
    return block;
  }

  void
  write_example(const std::string &path, const MPI_Comm comm, const std::vector<double> &block)
  {
    ArchiveWriter writer(path, comm);
    writer.write("points/F", block);
    writer.write("ids", std::vector<std::uint64_t>{(1ull << 60) + my_rank()});
    writer.attribute("time_s", 0.1);
    writer.attribute("step", std::uint64_t(42));
    writer.attribute("parameters", "set A = 1\n" + std::string(100000, 'x')); // more than an HDF5 attribute holds
    writer.commit();
  }

  /// Limits the size of files, as a full disk would, while it lives.
  class FileSizeLimit
  {
  public:
    explicit FileSizeLimit(const rlim_t bytes)
      : handler(std::signal(SIGXFSZ, SIG_IGN))
    {
      getrlimit(RLIMIT_FSIZE, &old);
      const rlimit limit = {bytes, old.rlim_max};
      setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit()
    {
      setrlimit(RLIMIT_FSIZE, &old);
      std::signal(SIGXFSZ, handler);
    }

  private:
    rlimit old;
    void (*handler)(int);
  };
} // namespace

TEST(Archive, MpiRoundTripOnTheSameRanks)
{
  const TemporaryFolder folder;
  write_example(folder / "a.h5", world, own_block());
  const ArchiveReader reader(folder / "a.h5", world);
  EXPECT_TRUE(reader.is_same_ranks());
  EXPECT_EQ(reader.read_double("points/F"), own_block());
  EXPECT_EQ(reader.read_uint64("ids"), std::vector<std::uint64_t>{(1ull << 60) + my_rank()});
  EXPECT_EQ(reader.attribute_double("time_s"), 0.1);
  EXPECT_EQ(reader.attribute_uint64("step"), 42u);
  EXPECT_EQ(reader.attribute_string("parameters"), "set A = 1\n" + std::string(100000, 'x'));
  EXPECT_TRUE(reader.has("ids"));
  EXPECT_FALSE(reader.has("nothing/here"));
}

TEST(Archive, MpiOtherNumberOfRanksGetsEvenShares)
{
  const TemporaryFolder folder;
  std::vector<double>   all(1000);
  std::iota(all.begin(), all.end(), 0.);
  if (my_rank() == 0) // written by one rank
    write_example(folder / "a.h5", MPI_COMM_SELF, all);
  MPI_Barrier(world);
  const ArchiveReader reader(folder / "a.h5", world);
  EXPECT_EQ(reader.is_same_ranks(), n_ranks() == 1);
  const auto share = reader.read_double("points/F");
  EXPECT_LE(share.size(), 1000 / n_ranks() + 1);
  std::vector<double> joined;
  for (const auto &part : dealii::Utilities::MPI::all_gather(world, share))
    joined.insert(joined.end(), part.begin(), part.end());
  EXPECT_EQ(joined, all);
}

TEST(Archive, MpiNothingBeforeCommit)
{
  const TemporaryFolder folder;
  {
    ArchiveWriter writer(folder / "a.h5", world);
    writer.write("x", own_block());
  }
  MPI_Barrier(world);
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(Archive, MpiBadFilesThrowOnAllRanks)
{
  const TemporaryFolder folder;
  const auto            open = [&](const std::string &name) {
    return message_of<UserError>([&] { ArchiveReader(folder / name, world).read_double("points/F"); });
  };
  EXPECT_NE(open("missing.h5").find("no such checkpoint"), std::string::npos);

  put_text(folder / "text.h5", "this is not HDF5");
  EXPECT_NE(open("text.h5").find("not a checkpoint"), std::string::npos) << open("text.h5");

  std::vector<double> block(10000);
  std::iota(block.begin(), block.end(), 1.);
  write_example(folder / "good.h5", world, block);
  EXPECT_EQ(open("good.h5"), "");
  const std::string bytes = read_text(folder / "good.h5");
  for (const double part : {0.0, 0.01, 0.3, 0.999})
    {
      put_text(folder / "cut.h5", bytes.substr(0, bytes.size() * part));
      EXPECT_NE(open("cut.h5").find("cut.h5"), std::string::npos) << part;
      MPI_Barrier(world);
    }

  const double      number  = 5000.; // somewhere in the first rank's block
  const std::string pattern = std::string(reinterpret_cast<const char *>(&number), 8);
  std::string       damaged = bytes;
  damaged[damaged.find(pattern) + 2] ^= 1;
  put_text(folder / "damaged.h5", damaged);
  EXPECT_NE(open("damaged.h5").find("'points/F' is damaged"), std::string::npos) << open("damaged.h5");
  EXPECT_EQ(ArchiveReader(folder / "damaged.h5", world).damage(), "points/F");
  EXPECT_EQ(ArchiveReader(folder / "good.h5", world).damage(), "");
}

TEST(Archive, MpiSingleValuesHaveChecksums)
{
  const TemporaryFolder folder;
  const double          time = 0.1234567890123;
  ArchiveWriter         writer(folder / "good.h5", world);
  writer.attribute("time", time);
  writer.attribute("text", std::string("a word to change"));
  writer.commit();
  EXPECT_EQ(ArchiveReader(folder / "good.h5", world).damage(), "");
  const std::string bytes = read_text(folder / "good.h5");
  for (const auto &[name, pattern] : {std::make_pair("time", std::string(reinterpret_cast<const char *>(&time), 8)),
                                      std::make_pair("text", std::string("a word"))})
    {
      std::string damaged = bytes;
      damaged[damaged.find(pattern) + 1] ^= 1;
      put_text(folder / "damaged.h5", damaged);
      const ArchiveReader reader(folder / "damaged.h5", world);
      EXPECT_EQ(reader.damage(), std::string("attributes/") + name);
      const std::string message = message_of<UserError>([&] { reader.attribute_double("time"); });
      EXPECT_EQ(message.find("'time' is damaged") != std::string::npos, std::string(name) == "time") << message;
      MPI_Barrier(world);
    }
}

TEST(Archive, MpiWrongNamesAndTypesThrowOnAllRanks)
{
  const TemporaryFolder folder;
  write_example(folder / "a.h5", world, own_block());
  const ArchiveReader reader(folder / "a.h5", world);
  EXPECT_THROW(reader.read_double("nothing"), UserError);
  EXPECT_THROW(reader.read_double("ids"), UserError);
  EXPECT_THROW(reader.attribute_double("step"), UserError);
  EXPECT_THROW(reader.attribute_string("time_s"), UserError);
  EXPECT_EQ(reader.attribute_uint64("step"), 42u); // still usable
}

TEST(Archive, MpiFailingWriteKeepsTheOlderFile)
{
  const TemporaryFolder folder;
  write_example(folder / "a.h5", world, own_block());
  const std::string before = read_text(folder / "a.h5");
  MPI_Barrier(world);
  std::string message;
  {
    const FileSizeLimit       limit(1000000);
    const std::vector<double> block(400000, 1.); // the first rank's alone is 3.2 MB
    message = message_of<OutputError>([&] { write_example(folder / "a.h5", world, block); });
  }
  EXPECT_NE(message.find("a.h5: the file was not written: "), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  EXPECT_EQ(read_text(folder / "a.h5"), before);
  EXPECT_FALSE(fs::exists(folder / "a.h5.tmp"));
}

TEST(Archive, MpiNoRoomIsRefusedBeforeWriting)
{
  const TemporaryFolder folder;
  const auto            free = fs::space(folder.path).available;
  // Never touched: only its size counts.
  const double       *nothing = nullptr;
  const std::uint64_t length  = free / sizeof(double);
  const std::string   message = message_of<OutputError>([&] {
    ArchiveWriter writer(folder / "a.h5", world);
    writer.write("x", dealii::ArrayView<const double>(nothing, my_rank() == 0 ? length + (1u << 28) : 0));
    writer.commit();
  });
  EXPECT_NE(message.find("no space left on the disk"), std::string::npos) << message;
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(Archive, MpiMissingFolderThrowsOnAllRanks)
{
  const TemporaryFolder folder;
  const std::string     message = message_of<OutputError>(
    [&] { write_example(folder / "missing/a.h5", world, own_block()); });
  EXPECT_NE(message.find("cannot be created"), std::string::npos) << message;
}

TEST(Checkpoints, MpiKeepsTheNewestTwoAndFindsTheLatestComplete)
{
  const TemporaryFolder folder;
  const Checkpoints     checkpoints(folder.path, world);
  EXPECT_EQ(checkpoints.latest(), "");
  put_text(folder / "checkpoint_old.h5", "foreign");
  for (const unsigned int step : {8, 9, 10})
    {
      write_example(checkpoints.path(step), world, own_block());
      checkpoints.remove_old();
    }
  EXPECT_FALSE(fs::exists(folder / "checkpoint_8.h5"));
  EXPECT_TRUE(fs::exists(folder / "checkpoint_9.h5"));
  EXPECT_TRUE(fs::exists(folder / "checkpoint_old.h5"));
  EXPECT_EQ(checkpoints.latest(), folder / "checkpoint_10.h5");
  MPI_Barrier(world);
  put_text(folder / "checkpoint_11.h5", "a file that was cut off");
  put_text(folder / "checkpoint_12.h5.tmp", "never committed");
  EXPECT_EQ(checkpoints.latest(), folder / "checkpoint_10.h5");
  checkpoints.remove_old();
  EXPECT_FALSE(fs::exists(folder / "checkpoint_12.h5.tmp"));

  // One changed number makes it unusable too.
  write_example(checkpoints.path(9), world, own_block());
  std::string       damaged = read_text(folder / "checkpoint_10.h5");
  const double      number  = 0.1; // its time
  const std::size_t place   = damaged.find(std::string(reinterpret_cast<const char *>(&number), 8));
  ASSERT_NE(place, std::string::npos);
  damaged[place] ^= 1;
  MPI_Barrier(world);
  put_text(folder / "checkpoint_10.h5", damaged);
  EXPECT_EQ(checkpoints.latest(), folder / "checkpoint_9.h5");
}
