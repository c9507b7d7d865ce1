#include "../world.h"
#include "temporary_folder.h"

#include <stroma/base/errors.h>
#include <stroma/output/folder.h>

#include <gtest/gtest.h>

using namespace Stroma;
using namespace Stroma::Output;
namespace fs = std::filesystem;

namespace
{
  /// The default folder is relative to the working directory: enter the temporary one.
  struct InFolder : TemporaryFolder
  {
    InFolder()
      : before(fs::current_path())
    {
      fs::current_path(path);
    }
    ~InFolder()
    {
      fs::current_path(before);
    }
    fs::path before;
  };

  std::string
  choose(const FolderRequest &request)
  {
    RunFolder folder(request, world);
    folder.open();
    MPI_Barrier(world);
    return folder.path();
  }
} // namespace

TEST(RunFolder, MpiDefaultTakesTheFirstUnused)
{
  const InFolder here;
  EXPECT_EQ(choose({"", "scenes/beam.prm", false, false}), "results/beam");
  EXPECT_EQ(choose({"", "scenes/beam.prm", false, false}), "results/beam-2");
  EXPECT_EQ(choose({"", "scenes/beam.prm", false, false}), "results/beam-3");
  EXPECT_EQ(choose({"", "scenes/beam.prm", false, true}), "results/beam-3");
  EXPECT_EQ(choose({"", "scenes/beam.prm", true, false}), "results/beam");
  EXPECT_TRUE(fs::is_directory("results/beam-3"));
  EXPECT_THROW(choose({"", "other.prm", false, true}), UserError);
}

TEST(RunFolder, MpiGivenFolderWithResultsIsRefused)
{
  const InFolder here;
  for (const std::string file : {"summary.json", "series.csv", "checkpoint_12.h5"})
    {
      const std::string name = "run_" + file;
      EXPECT_EQ(choose({name, "a.prm", false, false}), name); // new
      EXPECT_EQ(choose({name, "a.prm", false, false}), name); // empty
      put_text(name + "/notes.txt", "mine");
      EXPECT_EQ(choose({name, "a.prm", false, false}), name); // foreign files only
      put_text(name + "/" + file, "results");
      const std::string message = message_of<UserError>([&] { choose({name, "a.prm", false, false}); });
      EXPECT_EQ(message, "--output " + name +
                           ": the folder holds results; choose another folder, or --resume to continue, or --overwrite "
                           "to replace");
      EXPECT_EQ(choose({name, "a.prm", false, true}), name);
      EXPECT_TRUE(fs::exists(name + "/" + file));
    }
}

TEST(RunFolder, MpiOverwriteRemovesOwnFilesOnly)
{
  const InFolder    here;
  const std::string ours[]    = {"summary.json",         "series.csv",      "checkpoint_3.h5", "checkpoint_4.h5.tmp",
                                 "points_0001.0.12.vtu", "grid_0001.pvtu",  "points.pvd",      "points_0001.0.0.h5",
                                 "points.xdmf",          "points_0001.xdmf"};
  const std::string foreign[] = {"notes.txt",        "mesh_0001.vtu", "points_final.vtu",
                                 "summary.json.bak", "image.h5",      "states/mine.h5"};
  choose({"run", "a.prm", false, false});
  for (const std::string &name : ours)
    put_text("run/" + name, "x");
  if (TemporaryFolder::is_first())
    fs::create_directory("run/states");
  MPI_Barrier(world);
  for (const std::string &name : foreign)
    put_text("run/" + name, "x");
  put_text("run/states/state_00000012.h5", "x");
  RunFolder folder({"run", "a.prm", true, false}, world);
  EXPECT_TRUE(fs::exists("run/summary.json")); // until it is opened
  MPI_Barrier(world);
  folder.open();
  EXPECT_FALSE(fs::exists("run/states/state_00000012.h5"));
  for (const std::string &name : ours)
    EXPECT_FALSE(fs::exists("run/" + name)) << name;
  for (const std::string &name : foreign)
    EXPECT_TRUE(fs::exists("run/" + name)) << name;
}

TEST(RunFolder, MpiUnusableFoldersThrowOnAllRanks)
{
  const InFolder here;
  put_text("file", "x");
  EXPECT_NE(message_of<UserError>([&] {
              choose({"file", "a.prm", false, false});
            }).find("cannot be made"),
            std::string::npos);
  EXPECT_THROW(choose({"file/below", "a.prm", false, false}), UserError);
  EXPECT_NE(message_of<UserError>([&] {
              choose({"/proc", "a.prm", false, false});
            }).find("not writable"),
            std::string::npos);
  EXPECT_THROW(choose({"gone", "a.prm", false, true}), UserError);
  EXPECT_THROW(choose({"x", "a.prm", true, true}), UserError);
}

TEST(RunFolder, MpiLinksAreNotFollowed)
{
  const InFolder here;
  if (TemporaryFolder::is_first())
    {
      fs::create_directories("elsewhere");
      fs::create_directories("run");
    }
  MPI_Barrier(world);
  put_text("elsewhere/state_00000001.h5", "mine");
  put_text("target", "mine");
  if (TemporaryFolder::is_first())
    {
      fs::create_symlink("../target", "run/.stroma_probe");
      fs::create_symlink("../target", "run/series.csv");
      fs::create_directory_symlink("../elsewhere", "run/states");
    }
  MPI_Barrier(world);
  const std::string message = message_of<UserError>([&] { choose({"run", "a.prm", true, false}); });
  EXPECT_EQ(message, "run/states: this is a link, and files beyond it are not removed; remove the link");
  EXPECT_TRUE(fs::is_symlink("run/series.csv"));
  MPI_Barrier(world);
  if (TemporaryFolder::is_first())
    fs::remove("run/states");
  MPI_Barrier(world);
  choose({"run", "a.prm", true, false});
  EXPECT_FALSE(fs::is_symlink("run/series.csv"));
  EXPECT_EQ(read_text("target"), "mine");
  EXPECT_EQ(read_text("elsewhere/state_00000001.h5"), "mine");
}

TEST(RunFolder, MpiItsOwnInputAndPlacesOfOthersAreRefused)
{
  const InFolder here;
  if (TemporaryFolder::is_first())
    fs::create_directories("run");
  MPI_Barrier(world);
  put_text("run/parameters.prm", "mine");
  EXPECT_EQ(
    message_of<UserError>([&] {
      choose({"run", "run/parameters.prm", true, false});
    }),
    "--output run: the run would write over its own input run/parameters.prm; copy that file to another place or "
    "choose another --output");
  EXPECT_EQ(read_text("run/parameters.prm"), "mine");
  EXPECT_EQ(message_of<UserError>([&] {
              choose({"run/states", "a.prm", false, false});
            }),
            "--output run/states: this is where a run keeps its states; choose another --output");
  const std::string longest(300, 'a');
  EXPECT_EQ(message_of<UserError>([&] {
              choose({longest, "a.prm", false, false});
            }),
            longest + ": the output folder cannot be made (File name too long); choose another --output");
}

TEST(PathInside, StaysInside)
{
  EXPECT_EQ(path_inside("out", "Q1,cells=4", "study.prm:3"), "out/Q1,cells=4");
  for (const std::string name : {"", ".", "..", ".hidden", "a/b", "/etc", "../a", "a\\b", "a\nb"})
    EXPECT_NE(message_of<UserError>([&] { path_inside("out", name, "study.prm:3"); }).find("study.prm:3: "),
              std::string::npos)
      << name;
  EXPECT_THROW(path_inside("out", std::string(201, 'a'), ""), UserError);
}

TEST(RemoveRun, LeavesWhatIsNotARuns)
{
  const TemporaryFolder folder;
  const std::string     run = folder / "run" + std::to_string(dealii::Utilities::MPI::this_mpi_process(world));
  fs::create_directories(run + "/states");
  for (const std::string name : {"series.csv", "states/state_00000001.h5", "mine.txt"})
    std::ofstream(run + "/" + name) << "x";
  remove_run(run);
  EXPECT_FALSE(fs::exists(run + "/series.csv"));
  EXPECT_FALSE(fs::exists(run + "/states"));
  EXPECT_TRUE(fs::exists(run + "/mine.txt"));
  fs::remove(run + "/mine.txt");
  remove_run(run);
  EXPECT_FALSE(fs::exists(run));
}
