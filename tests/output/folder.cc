#include "temporary_folder.h"

#include <stroma/base/errors.h>
#include <stroma/output/folder.h>

#include <gtest/gtest.h>

using namespace Stroma;
using namespace Stroma::Output;
namespace fs = std::filesystem;

namespace
{
  const MPI_Comm world = MPI_COMM_WORLD;

  /// The default folder is relative to the working directory: enter the temporary one.
  struct InFolder : TemporaryFolder
  {
    InFolder() : before(fs::current_path()) { fs::current_path(path); }
    ~InFolder() { fs::current_path(before); }
    fs::path before;
  };

  std::string
  choose(const FolderRequest &request)
  {
    const std::string path = RunFolder(request, world).path();
    MPI_Barrier(world);
    return path;
  }
} // namespace

TEST(RunFolder, MpiDefaultTakesTheFirstUnused)
{
  const InFolder here;
  EXPECT_EQ(choose({ "", "scenes/beam.prm", false, false }), "results/beam");
  EXPECT_EQ(choose({ "", "scenes/beam.prm", false, false }), "results/beam-2");
  EXPECT_EQ(choose({ "", "scenes/beam.prm", false, false }), "results/beam-3");
  EXPECT_EQ(choose({ "", "scenes/beam.prm", false, true }), "results/beam-3");
  EXPECT_EQ(choose({ "", "scenes/beam.prm", true, false }), "results/beam");
  EXPECT_TRUE(fs::is_directory("results/beam-3"));
  EXPECT_THROW(choose({ "", "other.prm", false, true }), UserError);
}

TEST(RunFolder, MpiGivenFolderWithResultsIsRefused)
{
  const InFolder here;
  for (const std::string file : { "summary.json", "series.csv", "checkpoint_12.h5" })
  {
    const std::string name = "run_" + file;
    EXPECT_EQ(choose({ name, "a.prm", false, false }), name); // new
    EXPECT_EQ(choose({ name, "a.prm", false, false }), name); // empty
    put_text(name + "/notes.txt", "mine");
    EXPECT_EQ(choose({ name, "a.prm", false, false }), name); // foreign files only
    put_text(name + "/" + file, "results");
    const std::string message = message_of<UserError>([&] { choose({ name, "a.prm", false, false }); });
    EXPECT_EQ(message,
              "--output " + name
                  + ": the folder holds results; choose another folder, or --resume to continue, or --overwrite "
                    "to replace");
    EXPECT_EQ(choose({ name, "a.prm", false, true }), name);
    EXPECT_TRUE(fs::exists(name + "/" + file));
  }
}

TEST(RunFolder, MpiOverwriteRemovesOwnFilesOnly)
{
  const InFolder    here;
  const std::string ours[]
      = { "summary.json",   "series.csv", "checkpoint_3.h5",    "checkpoint_4.h5.tmp", "points_0001.0.12.vtu",
          "grid_0001.pvtu", "points.pvd", "points_0001.0.0.h5", "points.xdmf",         "points_0001.xdmf" };
  const std::string foreign[] = { "notes.txt", "mesh_0001.vtu", "points_final.vtu", "summary.json.bak", "image.h5" };
  choose({ "run", "a.prm", false, false });
  for (const std::string &name : ours)
    put_text("run/" + name, "x");
  for (const std::string &name : foreign)
    put_text("run/" + name, "x");
  choose({ "run", "a.prm", true, false });
  for (const std::string &name : ours)
    EXPECT_FALSE(fs::exists("run/" + name)) << name;
  for (const std::string &name : foreign)
    EXPECT_TRUE(fs::exists("run/" + name)) << name;
}

TEST(RunFolder, MpiUnusableFoldersThrowOnAllRanks)
{
  const InFolder here;
  put_text("file", "x");
  EXPECT_NE(message_of<UserError>(
                [&] {
                  choose({ "file", "a.prm", false, false });
                })
                .find("cannot be made"),
            std::string::npos);
  EXPECT_THROW(choose({ "file/below", "a.prm", false, false }), UserError);
  EXPECT_NE(message_of<UserError>(
                [&] {
                  choose({ "/proc", "a.prm", false, false });
                })
                .find("not writable"),
            std::string::npos);
  EXPECT_THROW(choose({ "gone", "a.prm", false, true }), UserError);
  EXPECT_THROW(choose({ "x", "a.prm", true, true }), UserError);
}
