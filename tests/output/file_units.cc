#include <stroma/base/parameters.h>
#include <stroma/output/file_units.h>

#include <gtest/gtest.h>

using namespace Stroma;

TEST(FileUnits, AreThoseOfTheScene)
{
  const auto file = ParameterFile::parse("subsection Units\n set Length = um\n set Stress = kPa\nend\n", "f.prm");
  const Output::FileUnits units{Parameters(file)};
  EXPECT_FALSE(units.is_si());
  EXPECT_EQ(units.name("displacement", "m"), "displacement_um");
  EXPECT_DOUBLE_EQ(units.of("m").factor, 1e6);
  EXPECT_EQ(units.name("velocity", "m_per_s"), "velocity_um_per_s");
  EXPECT_DOUBLE_EQ(units.of("m_per_s").factor, 1e6);
  EXPECT_EQ(units.name("density", "kg_per_m3"), "density_kg_per_um3");
  EXPECT_DOUBLE_EQ(units.of("kg_per_m3").factor, 1e-18);
  EXPECT_EQ(units.name("von_mises", "Pa"), "von_mises_kPa");
  EXPECT_EQ(units.name("J", ""), "J");
  EXPECT_DOUBLE_EQ(units.of("").factor, 1.);
  const Output::FileUnits si;
  EXPECT_EQ(si.name("velocity", "m_per_s"), "velocity_m_per_s");
  EXPECT_DOUBLE_EQ(si.of("m_per_s").factor, 1.);
  EXPECT_TRUE(si.is_si());
}
