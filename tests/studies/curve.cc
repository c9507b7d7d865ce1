#include "../output/temporary_folder.h"

#include <stroma/base/errors.h>
#include <stroma/studies/curve.h>

#include <gtest/gtest.h>

using namespace Stroma::Studies;

namespace
{
  Curve
  curve_of(const std::string &rows)
  {
    const TemporaryFolder folder;
    put_text(folder / "series.csv", "time_s,strain_y,force_N\n" + rows);
    return read_curve(folder.path, "strain_y", "force_N", "here", MPI_COMM_WORLD);
  }
} // namespace

TEST(Curve, DataBeyondItsEnds)
{
  const auto rising = curve_of("0,0,0\n1,.1,2\n"), falling = curve_of("0,0,0\n1,-.1,2\n");
  EXPECT_TRUE(rising.reaches(.1 + 1e-8) && rising.reaches(0.) && falling.reaches(-.1));
  EXPECT_FALSE(rising.reaches(.11) || rising.reaches(-.01) || falling.reaches(.01));
  EXPECT_TRUE(rising.is_before_run(-.01) && falling.is_before_run(.01));
  EXPECT_FALSE(rising.is_before_run(.11) || rising.is_before_run(.05) || falling.is_before_run(-.11));
  EXPECT_EQ(beyond_run(rising, "strain_y", .2),
            "'strain_y' is 0.2 here, but goes from 0 to 0.1 in the run; let the scene "
            "go farther, or leave the line out");
  EXPECT_EQ(beyond_run(falling, "strain_y", .2),
            "'strain_y' is 0.2 here, but goes from 0 to -0.1 in the run; the data lie before its first row: check "
            "their sign and column, or leave the line out");
}

TEST(Curve, StraightLinesStandForFewRows)
{
  const auto few = curve_of("0,0,0\n1,.1,2\n2,.2,3\n"), enough = curve_of("0,0,0\n1,.1,2\n2,.2,3\n3,.3,3.5\n");
  EXPECT_TRUE(few.is_only_line(.15));
  EXPECT_FALSE(few.is_only_line(.1) || few.is_only_line(.2) || enough.is_only_line(.15));
}
