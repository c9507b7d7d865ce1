#include "../output/temporary_folder.h"

#include <stroma/base/errors.h>
#include <stroma/studies/measured.h>

#include <gtest/gtest.h>

using namespace Stroma;
using namespace Stroma::Studies;

namespace
{
  const std::string     force = "reaction_force_y_N";
  const MeasuredColumns plain{"strain_y", force, ""};

  Measured
  measured_in(const std::string &text, const MeasuredColumns &columns)
  {
    const TemporaryFolder folder;
    put_text(folder / "data.csv", text);
    return read_measured(folder / "data.csv", columns, MPI_COMM_WORLD);
  }

  /// What is said of a file with such a text, without its path.
  std::string
  refusal_of(const std::string &text, const MeasuredColumns &columns)
  {
    const auto message = message_of<UserError>([&] { measured_in(text, columns); });
    const auto name    = message.find("data.csv");
    return name == std::string::npos ? message : message.substr(name);
  }
} // namespace

TEST(Measured, DeviationsHaveTheUnitInTheNameOfTheirColumn)
{
  const std::string rows   = "\n.1,2,.5\n";
  const auto        factor = [&](const std::string &y, const std::string &deviation, const std::string &wanted) {
    const auto found = measured_in("strain_y," + y + "," + deviation + rows, {"strain_y", force, wanted});
    return found.deviation[0] / .5;
  };
  EXPECT_DOUBLE_EQ(factor("reaction_force_y_nN", "sd_nN", "sd_nN"), 1e-9);
  EXPECT_DOUBLE_EQ(factor("reaction_force_y_nN", "sd_mN", "sd_mN"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("reaction_force_y_nN", "sd_mN", "sd_N"), 1e-3);
  EXPECT_DOUBLE_EQ(factor("reaction_force_y_nN", "sd_N", "sd_N"), 1.);
  EXPECT_DOUBLE_EQ(factor("reaction_force_y_nN", "sd", "sd"), 1e-9);
  EXPECT_DOUBLE_EQ(factor("reaction_force_y_nN", "sd_of_five", "sd_of_five"), 1e-9);
  EXPECT_DOUBLE_EQ(factor("reaction_force_y_N", "sd", "sd"), 1.);
  EXPECT_THROW(factor("reaction_force_y_N", "sd_kPa", "sd_kPa"), UserError);
}

TEST(Measured, MultiplesOfUnits)
{
  const auto found = measured_in("time_min,reaction_force_y_mN\n1,2\n2,3\n", {"time_s", force, ""});
  EXPECT_DOUBLE_EQ(found.x[1], 120.);
  EXPECT_DOUBLE_EQ(found.y[1], 3e-3);
}

TEST(Measured, MultiplesOfUnitsWithPer)
{
  const MeasuredColumns speed{"time_s", "max_speed_m_per_s", ""};
  EXPECT_DOUBLE_EQ(measured_in("time_s,max_speed_m_per_s\n1,2\n", speed).y[0], 2.);
  EXPECT_DOUBLE_EQ(measured_in("time_s,max_speed_um_per_h\n1,3600\n", speed).y[0], 1e-6);
  EXPECT_DOUBLE_EQ(measured_in("time_s,max_speed_m_per_ms\n1,2\n", speed).y[0], 2000.);
  const MeasuredColumns with_deviation{"time_s", "max_speed_m_per_s", "sd_um_per_min"};
  EXPECT_DOUBLE_EQ(measured_in("time_s,max_speed_m_per_s,sd_um_per_min\n1,2,60\n", with_deviation).deviation[0], 1e-6);
  const MeasuredColumns flow{"time_s", "flow_rate_x_m3_per_s", ""};
  EXPECT_DOUBLE_EQ(measured_in("time_s,flow_rate_x_mm3_per_min\n1,60\n", flow).y[0], 1e-9);
  EXPECT_EQ(
    refusal_of("time_s,max_speed_m_per_lb\n1,2\n", speed),
    "data.csv:1: no column is called 'max_speed_m_per_s' (or with multiples of its parts for m_per_s); the first "
    "line of the file must name it, and has: time_s, max_speed_m_per_lb");
}

TEST(Measured, TwoColumnsOfOneQuantityAreRefused)
{
  EXPECT_EQ(refusal_of("strain_y,reaction_force_y_N,reaction_force_y_mN\n.1,2,2000\n", plain),
            "data.csv:1: columns 2 ('reaction_force_y_N') and 3 ('reaction_force_y_mN') both give "
            "'reaction_force_y_N'; keep one of them");
  EXPECT_EQ(refusal_of("strain_y,reaction_force_y_N,strain_y\n.1,2,.1\n", plain),
            "data.csv:1: columns 1 ('strain_y') and 3 ('strain_y') both give 'strain_y'; keep one of them");
}

TEST(Measured, ByteOrderMark)
{
  EXPECT_DOUBLE_EQ(measured_in("\xEF\xBB\xBFstrain_y,reaction_force_y_N\r\n.1,2\r\n", plain).x[0], .1);
}

TEST(Measured, FilesThatAreNone)
{
  const TemporaryFolder folder;
  EXPECT_EQ(message_of<UserError>([&] { read_measured(folder / "none.csv", plain, MPI_COMM_WORLD); }),
            (folder / "none.csv") + ": there is no such file, here or beside the parameter file; correct 'File'");
  EXPECT_EQ(message_of<UserError>([&] { read_measured(folder.path, plain, MPI_COMM_WORLD); }),
            folder.path + ": this is no plain file; 'File' must name one with comma-separated values");
  EXPECT_EQ(refusal_of("", plain), "data.csv: the file holds no line; the first must name its columns");
}
