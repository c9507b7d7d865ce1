#include <stroma/base/expression.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  TEST(SpaceTimeVector, WorksInTheFilesUnits)
  {
    const auto         file = ParameterFile::parse("subsection Units\n set Length = um\n set Time = ms\nend\n"
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
    for (const std::string text : {"1", "1; 2; 3", "1; q*t", "free; 1", "0; 0,5", "0; 0,01*y*t", "0; y=3", "0; rand()",
                                   "0; z", "1; 2;", "0; sqrt(-1)", "1/0; 0", "0; min(t,0,5)", "0; 1e400"})
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
            EXPECT_EQ(std::string(error.what()).find("f.prm:1: 'Force' was given as '" + text + "'"), 0u)
              << error.what();
          }
      }
  }

  TEST(SpaceTimeVector, NotesWhereAndWhenItIsNotFinite)
  {
    const auto file = ParameterFile::parse("subsection Units\n set Length = um\nend\nset Force = 1; sqrt(2-t)/(x+y)\n",
                                           "f.prm");
    Parameters p(file);
    SpaceTimeVector<2> v;
    forget_not_finite();
    v.add(p, "Force", "force", "N", false); // not finite at the origin, where nothing need be
    v.value(dealii::Point<2>(1e-6, 3e-6), 1.);
    EXPECT_EQ(first_not_finite(MPI_COMM_SELF), "");
    v.value(dealii::Point<2>(1e-6, 3e-6), 5.);
    v.value(dealii::Point<2>(1e-6, 3e-6), 6.);
    EXPECT_EQ(
      first_not_finite(MPI_COMM_SELF),
      "f.prm:4: 'Force' (1; sqrt(2-t)/(x+y)) is not finite at x = 1 um, y = 3 um, t = 5 s (component 2); change it so that "
      "it is finite wherever it acts");
    forget_not_finite();
    EXPECT_EQ(first_not_finite(MPI_COMM_SELF), "");
  }
} // namespace
