#include "../world.h"
#include "temporary_folder.h"

#include <stroma/base/errors.h>
#include <stroma/base/output_error.h>
#include <stroma/output/series.h>

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <cmath>
#include <csignal>

using namespace Stroma;
using namespace Stroma::Output;

namespace
{
}

TEST(TimeSeries, MpiRowsAreOnDiskAtOnceAndReadBackExactly)
{
  const TemporaryFolder folder;
  TimeSeries            series(folder / "series.csv", world);
  series.add({{"time_s", 0.}, {"force_N", 1. / 3.}});
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,force_N\n0,0.3333333333333333\n");
  MPI_Barrier(world);
  series.add({{"time_s", 0.1}, {"force_N", std::nan("")}});
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,force_N\n0,0.3333333333333333\n0.1,nan\n");
}

TEST(TimeSeries, MpiColumnsCannotChange)
{
  const TemporaryFolder folder;
  TimeSeries            series(folder / "series.csv", world);
  series.add({{"time_s", 0.}, {"force_N", 1.}});
  const std::string message = message_of<UserError>([&] { series.add({{"time_s", 0.1}, {"work_J", 1.}}); });
  EXPECT_NE(message.find("'time_s,force_N'"), std::string::npos) << message;
  EXPECT_NE(message.find("'time_s,work_J'"), std::string::npos) << message;
}

TEST(TimeSeries, MpiResumeDropsLaterAndHalfRows)
{
  const TemporaryFolder folder;
  put_text(folder / "series.csv", "time_s,a\n0,1\n0.1,2\n0.30000000000000004,3\n0.4,4\n0.2");
  TimeSeries series(folder / "series.csv", world);
  EXPECT_TRUE(series.resume(0.3));
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,a\n0,1\n0.1,2\n0.30000000000000004,3\n");
  MPI_Barrier(world);
  EXPECT_THROW(series.add({{"time_s", 0.5}, {"b", 1.}}), UserError);
  series.add({{"time_s", 0.5}, {"a", 5.}});
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,a\n0,1\n0.1,2\n0.30000000000000004,3\n0.5,5\n");
}

TEST(TimeSeries, MpiSaysWhetherTheLastRowIsThere)
{
  const TemporaryFolder folder;
  put_text(folder / "series.csv", "time_s,a\n0,1\n0.1,2\n0.2");
  EXPECT_FALSE(TimeSeries(folder / "series.csv", world).resume(0.2));
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,a\n0,1\n0.1,2\n");
  MPI_Barrier(world);
  EXPECT_TRUE(TimeSeries(folder / "series.csv", world).resume(0.1));
}

TEST(TimeSeries, MpiNamesAreQuotedAndNotGivenTwice)
{
  const TemporaryFolder folder;
  TimeSeries            series(folder / "series.csv", world);
  series.add({{"time_s", 0.}, {"top, right \"A\"", 1.}});
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,\"top, right \"\"A\"\"\"\n0,1\n");
  EXPECT_EQ(message_of<UserError>([&] {
              check_names({{"a", 0.}, {"b", 1.}, {"a", 2.}});
            }),
            "two results are called 'a'; give the supports, bodies or probes behind them other names");
}

TEST(TimeSeries, MpiARowThatDoesNotFitLeavesNoHalf)
{
  const TemporaryFolder folder;
  TimeSeries            series(folder / "series.csv", world);
  series.add({{"time_s", 0.}, {"a", 1.}});
  rlimit old;
  getrlimit(RLIMIT_FSIZE, &old);
  const auto   old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small       = {16, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string message = message_of<OutputError>([&] { series.add({{"time_s", 0.125}, {"a", 1. / 3.}}); });
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(message, folder / "series.csv" + ": the row cannot be written (disk full or folder not writable)");
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,a\n0,1\n");
}

TEST(TimeSeries, MpiResumeRefusesAForeignFile)
{
  const TemporaryFolder folder;
  put_text(folder / "series.csv", "something else\n1\n");
  TimeSeries series(folder / "series.csv", world);
  EXPECT_THROW(series.resume(1.), UserError);
  EXPECT_EQ(read_text(folder / "series.csv"), "something else\n1\n");
}

TEST(TimeSeries, MpiResumeWithoutAFileStartsAnew)
{
  const TemporaryFolder folder;
  TimeSeries            series(folder / "series.csv", world);
  series.resume(1.);
  series.add({{"time_s", 2.}});
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s\n2\n");
}
