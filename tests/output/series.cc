#include "temporary_folder.h"

#include <stroma/base/errors.h>
#include <stroma/output/series.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace Stroma;
using namespace Stroma::Output;

namespace
{
  const MPI_Comm world = MPI_COMM_WORLD;
}

TEST(TimeSeries, MpiRowsAreOnDiskAtOnceAndReadBackExactly)
{
  const TemporaryFolder folder;
  TimeSeries            series(folder / "series.csv", world);
  series.add({ { "time_s", 0. }, { "force_N", 1. / 3. } });
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,force_N\n0,0.3333333333333333\n");
  MPI_Barrier(world);
  series.add({ { "time_s", 0.1 }, { "force_N", std::nan("") } });
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,force_N\n0,0.3333333333333333\n0.1,nan\n");
}

TEST(TimeSeries, MpiColumnsCannotChange)
{
  const TemporaryFolder folder;
  TimeSeries            series(folder / "series.csv", world);
  series.add({ { "time_s", 0. }, { "force_N", 1. } });
  const std::string message = message_of<UserError>([&] { series.add({ { "time_s", 0.1 }, { "work_J", 1. } }); });
  EXPECT_NE(message.find("'time_s,force_N'"), std::string::npos) << message;
  EXPECT_NE(message.find("'time_s,work_J'"), std::string::npos) << message;
}

TEST(TimeSeries, MpiResumeDropsLaterAndHalfRows)
{
  const TemporaryFolder folder;
  put_text(folder / "series.csv", "time_s,a\n0,1\n0.1,2\n0.30000000000000004,3\n0.4,4\n0.2");
  TimeSeries series(folder / "series.csv", world);
  series.resume(0.3);
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,a\n0,1\n0.1,2\n0.30000000000000004,3\n");
  MPI_Barrier(world);
  EXPECT_THROW(series.add({ { "time_s", 0.5 }, { "b", 1. } }), UserError);
  series.add({ { "time_s", 0.5 }, { "a", 5. } });
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s,a\n0,1\n0.1,2\n0.30000000000000004,3\n0.5,5\n");
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
  series.add({ { "time_s", 2. } });
  EXPECT_EQ(read_text(folder / "series.csv"), "time_s\n2\n");
}
