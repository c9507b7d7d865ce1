#include "scene_of.h"

#include <stroma/scene/consistency.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  /// A block with two supports of these motions; the message about their shared corner along @p component, or "".
  std::string
  disagreement(const std::string &first, const std::string &second, const unsigned int component = 0)
  {
    const SceneOf<2>       s(box("block", "0, 0", "1, 1"),
                             "subsection Supports\n subsection left\n  set Where = side x-min\n" + first +
                               " end\n subsection bottom\n  set Where = side y-min\n" + second + " end\nend\n");
    const dealii::Point<2> corner(0., 0.);
    return message_of([&] { check_agreement<2>(s.scene, {0, corner}, {1, corner}, component, 1.); });
  }

  std::string
  moved(const std::string &x, const std::string &y = "0")
  {
    return "  set Displacement = " + x + "; " + y + "\n";
  }

  std::string
  driven(const std::string &x)
  {
    return "  set Type = velocity\n  set Velocity = " + x + "; 0\n";
  }
} // namespace

namespace
{
  /// Of a support of these entries on a side, or on a rigid ball below it.
  std::string
  unrest(const std::string &where, const std::string &entries)
  {
    const SceneOf<2> s(box("block", "0, 0", "1, 1", "  set Material = gel\n") +
                         " subsection disk\n  set Shape = ball\n  set Rigid = true\n  set Centre = 0.5, -.3\n"
                         "  set Radius = 0.2\n end\n",
                       section("Supports", "top", "  set Where = " + where + "\n" + entries));
    return message_of([&] { s.scene.check_rest_at_start(); });
  }
} // namespace

TEST(Consistency, NothingIsDisplacedAtTheStartWhereForcesFollowFromRates)
{
  EXPECT_NE(unrest("side y-max", "  set Displacement = 0; 0.1*cos(t)\n").find("displaced by 0.1 m along y at t = 0"),
            std::string::npos);
  EXPECT_NE(unrest("side y-max", "  set Displacement = free; 0.1*x\n").find("at t = 0"), std::string::npos);
  EXPECT_NE(unrest("body disk", "  set Displacement = 0; 0\n  set Rotation = 0.1 + t\n").find("turned by 0.1 rad"),
            std::string::npos);
  EXPECT_EQ(unrest("side y-max", "  set Displacement = 0; 0.1*y*sin(t)\n"), "");
  EXPECT_EQ(unrest("side y-max", "  set Type = velocity\n  set Velocity = 0; 1\n"), "");
  EXPECT_EQ(unrest("body disk", "  set Displacement = 0; t\n  set Rotation = t\n"), "");
}

TEST(Consistency, NoOscillationHidesFromTheTimes)
{
  const auto times = sample_times(3.);
  EXPECT_EQ(*std::min_element(times.begin(), times.end()), 0.);
  EXPECT_EQ(*std::max_element(times.begin(), times.end()), 3.);
  for (unsigned int waves = 1; waves <= 60; ++waves)
    {
      double largest = 0.;
      for (const double t : times)
        largest = std::max(largest, std::abs(std::sin(2. * dealii::numbers::PI * waves * t / 3.)));
      EXPECT_GT(largest, .5) << waves;
    }
}

TEST(Consistency, EqualMotionsAgreeAndOthersAreTold)
{
  EXPECT_EQ(disagreement(moved(".1*t"), moved("t*.05*2")), "");
  EXPECT_EQ(disagreement(moved("0", ".1*t"), moved("0", "0"), 0), "");
  const auto message = disagreement(moved("0", ".1*t"), moved("0", "0"), 1);
  EXPECT_NE(message.find("supports 'left' and 'bottom' contradict each other: at t = 0.5 s"), std::string::npos)
    << message;
  EXPECT_NE(message.find("by 0.05 m along y"), std::string::npos) << message;
  EXPECT_NE(disagreement(moved(".1*sin(4*pi*t)"), moved("0")), ""); // zero at both ends and in the middle
}

TEST(Consistency, ADisplacementAgreesWithItsVelocity)
{
  EXPECT_EQ(disagreement(moved(".1*t^2"), driven(".2*t")), "");
  EXPECT_NE(disagreement(moved(".1*t^2"), driven(".3*t")).find(" m/s along x"), std::string::npos);
}

TEST(Consistency, ASupportThatReachesABodyAtRestIsTold)
{
  const SceneOf<2>       s(box("block", "0, 0", "1, 1"),
                           section("Supports", "pull", "  set Where = side x-max\n" + moved("t")));
  const dealii::Point<2> X(1., 0.);
  EXPECT_NE(message_of([&] {
              check_agreement<2>(s.scene, {1, X}, {0, X}, 0, 1.);
            }).find("'pull' moves the surface of a rigid body that is at rest"),
            std::string::npos);
}
