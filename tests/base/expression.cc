#include <stroma/base/expression.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  TEST(SpaceTimeVector, WorksInTheFilesUnits)
  {
    const auto file = ParameterFile::parse("subsection Units\n set Length = um\n set Time = ms\nend\n"
                                           "subsection Constants\n set a = 2\nend\n"
                                           "set Displacement = free; a*y*t\n",
                                           "f.prm");
    Parameters         p(file);
    SpaceTimeVector<2> v;
    v.add(p, "Displacement", "displacement", "m", true);
    EXPECT_TRUE(v.is_free(0));
    // 2 * 3 um * 5 ms = 30 um
    EXPECT_NEAR(v.value(dealii::Point<2>(1e-6, 3e-6), 5e-3, 1), 30e-6, 1e-18);
    EXPECT_EQ(v.value(dealii::Point<2>(1e-6, 3e-6), 5e-3)[0], 0.);
  }

  TEST(SpaceTimeVector, RefusesWrongExpressionsWithThePlace)
  {
    for (const std::string text : {"1", "1; 2; 3", "1; q*t", "free; 1"})
      {
        const auto         file = ParameterFile::parse("set Force = " + text + "\n", "f.prm");
        Parameters         p(file);
        SpaceTimeVector<2> v;
        try
          {
            v.add(p, "Force", "force", "N", false);
            ADD_FAILURE() << text << " was taken";
          }
        catch (const UserError &error)
          {
            EXPECT_EQ(std::string(error.what()).find("f.prm:1: 'Force' was given as '" + text + "'"), 0u) << error.what();
          }
      }
  }
} // namespace
