// What moves with a side on a grid that is reset.

#include "fixture.h"

#include <stroma/grid/connected_parts.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  std::string
  block(const std::string &bottom, const std::string &more = "", const std::string &mpm = " set Grid reset = always\n")
  {
    return "subsection Materials\n subsection gel\n set Law = neo-Hookean\n set Shear modulus = 2\n set Bulk modulus = 5\n"
           " end\nend\nsubsection Bodies\n subsection block\n set Shape = box\n set Upper corner = 1, 1\n end\nend\n"
           "subsection Supports\n subsection bottom\n set Where = side y-min\n set Displacement = " +
           bottom + "\n end\n" + more + "end\nsubsection MPM\n set Cells = 4, 4\n" + mpm + "end\n";
  }

  unsigned int
  n_groups(const SystemFixture<2> &s)
  {
    return ConnectedParts<2>(s.grid->triangulation, s.points->occupied_cells()).n_groups();
  }

  TEST(PrescribedMotion, OfANodeIsThatOfTheMaterialThereAfterAReset)
  {
    SystemFixture<2> s(block("0.5*x*t; 0"));
    ASSERT_FALSE(s.motion->drives_points(0));
    // At t = .2 the node at x = .55 holds what was at X = .5; it moves by .5 X .2 until t = .4.
    Mpm::PrescribedMotion<2>::HeldUnknown unknown{0, 0, 0, {.55, 0.}, {{{.55, 0.}, 1.}}};
    EXPECT_NEAR(s.motion->motion_of(unknown, .4, .2), .05, 1e-13);
    EXPECT_NEAR(s.motion->motion_of(unknown, .4, 0.), .11, 1e-15); // never reset yet
    unknown.component = 1;
    EXPECT_EQ(s.motion->motion_of(unknown, .4, .2), 0.);
  }

  TEST(PrescribedMotion, OfASideThatLeavesItsPlaneDrivesPoints)
  {
    EXPECT_TRUE(SystemFixture<2>(block("0; 0.1*t")).motion->drives_points(0));
    EXPECT_TRUE(SystemFixture<2>(block("0; 0.1*(y-0.5)*t")).motion->drives_points(0)); // at rest only at the centre
    EXPECT_TRUE(SystemFixture<2>(block("0; 0.1*x*(1-x)*(x-0.5)*t")).motion->drives_points(0));
    EXPECT_FALSE(SystemFixture<2>(block("0; 0.1*y*t")).motion->drives_points(0));
    EXPECT_FALSE(SystemFixture<2>(block("0.3*t; 0")).motion->drives_points(0));
  }

  /// Moves what lies above @p y by @p distance upwards and resets the grid.
  void
  lift(SystemFixture<2> &s, const double y, const double distance)
  {
    for (auto &point : s.points->handler)
      if (auto x = point.get_location(); x[1] > y)
        {
          x[1] += distance;
          point.set_location(x);
        }
    s.points->move_to_their_cells();
    s.system->rebuild();
  }

  TEST(PrescribedMotion, MpiLosesASideThatTheMaterialLeaves)
  {
    SystemFixture<2> s(block("0; 0", "", " set Grid reset = always\n set Margin above = 0, 1\n"));
    const auto       n = s.points->handler.n_global_particles();
    ASSERT_TRUE(s.motion->holds_nodes());
    lift(s, 0., .5);
    EXPECT_FALSE(s.motion->holds_nodes());
    EXPECT_EQ(s.points->handler.n_global_particles(), n);
    EXPECT_THROW(s.motion->check_nodes(*s.grid), UserError);
    EXPECT_EQ(n_groups(s), 1u);
  }

  TEST(PrescribedMotion, MpiTornBodiesHangTogetherInMoreParts)
  {
    SystemFixture<2> s(block("0; 0", "", " set Grid reset = always\n set Margin above = 0, 1\n"));
    EXPECT_EQ(n_groups(s), 1u);
    lift(s, .5, .25);
    EXPECT_EQ(n_groups(s), 2u);
    EXPECT_TRUE(s.motion->holds_nodes());
  }

  TEST(PrescribedMotion, NearestIsOnePoint)
  {
    SystemFixture<2> s(
      block("free; 0", " subsection pin\n set Where = nearest 0.5, 0.5\n set Displacement = 0; free\n end\n"));
    unsigned int n = 0;
    for (const auto &point : s.points->handler)
      n += point.get_properties()[s.points->support.first] > 0;
    EXPECT_EQ(n, 1u);
  }

  TEST(PrescribedMotion, SupportsThatPullTheSamePointsApartAreRefused)
  {
    const std::string up   = " subsection up\n set Where = layer y-max 0.5\n set Displacement = 0; 0.1*t\n end\n",
                      down = " subsection down\n set Where = layer y-max 0.25\n set Displacement = 0; -0.1*t\n end\n";
    EXPECT_NO_THROW(SystemFixture<2>(block("0; 0", up)));
    EXPECT_THROW(SystemFixture<2>(block("0; 0", up + down)), UserError);
  }
} // namespace
