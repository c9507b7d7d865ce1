#include "../base/message_of.h"

#include <stroma/scene/region.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  using Plane = Region<2>;
  using P     = dealii::Point<2>;

  const dealii::BoundingBox<2> two_by_one({P(0., 0.), P(2., 1.)});

  Plane
  region(const std::string &where, const std::string &units = "")
  {
    const auto file = ParameterFile::parse(units + "set Where = " + where + "\n", "test.prm");
    Parameters p(file);
    Plane      result;
    result.add(p, {{"gel", "stiff"}, {"block", "punch"}});
    return result;
  }
} // namespace

TEST(Region, SidesAndRimsAreBoundary)
{
  const auto side = region("side x-max");
  EXPECT_TRUE(side.is_boundary());
  EXPECT_EQ(side.side_coordinate(two_by_one), 2.);
  EXPECT_EQ(region("side y-min").side_coordinate(two_by_one), 0.);
  EXPECT_TRUE(side.on_boundary(P(1.99, .3), two_by_one, .02));
  EXPECT_FALSE(side.on_boundary(P(1.99, .3), two_by_one, .005));
  EXPECT_FALSE(side.contains(P(2., .3), 0, two_by_one)); // a side holds no material

  const auto rim = region("rim 1, 0 : .5");
  EXPECT_TRUE(rim.is_boundary());
  EXPECT_TRUE(rim.on_boundary(P(1.3, .4), two_by_one, 1e-9));
  EXPECT_FALSE(rim.on_boundary(P(1.3, .3), two_by_one, 1e-9));
}

TEST(Region, SetsOfMaterialHoldTheirEdges)
{
  const auto holds = [](const Plane &r, const double x, const double y, const unsigned int material = 0) {
    return r.contains(P(x, y), material, two_by_one);
  };
  const auto layer = region("layer y-max .25");
  EXPECT_TRUE(holds(layer, 1., .75) && holds(layer, 0., 1.));
  EXPECT_FALSE(holds(layer, 1., .7499));
  const auto box = region("box .5, .5 : 1, 1");
  EXPECT_TRUE(holds(box, .5, .5) && holds(box, 1., 1.) && holds(box, .7, .6));
  EXPECT_FALSE(holds(box, .4999, .6) || holds(box, .7, 1.0001));
  const auto ball = region("ball 1, .5 : .5");
  EXPECT_TRUE(holds(ball, 1.3, .9));
  EXPECT_FALSE(holds(ball, 1.31, .9));
  EXPECT_TRUE(holds(region("material stiff"), 0., 0., 1));
  EXPECT_FALSE(holds(region("material stiff"), 0., 0., 0));
  EXPECT_TRUE(holds(region("all"), 9., 9.));
  EXPECT_FALSE(holds(region("nearest 1, 0"), 1., 0.));
  EXPECT_EQ(region("body punch").body, 1u);
}

TEST(Region, BoundsTakeItIn)
{
  const auto corners = [](const std::string &where) { return region(where).bounds(two_by_one).get_boundary_points(); };
  const auto ball    = corners("ball 1, .5 : .25");
  EXPECT_EQ(ball.first, P(.75, .25));
  EXPECT_EQ(ball.second, P(1.25, .75));
  const auto box = corners("box .5, .1 : 1, .2");
  EXPECT_EQ(box.first, P(.5, .1));
  EXPECT_EQ(box.second, P(1., .2));
  const auto layer = corners("layer y-max .25");
  EXPECT_EQ(layer.first, P(0., .75));
  EXPECT_EQ(layer.second, P(2., 1.25));
}

TEST(Region, LengthsAreInTheFilesUnit)
{
  const auto ball = region("ball 1, 2 : 2*2", "subsection Units\n set Length = um\nend\n");
  EXPECT_NEAR(ball.first[1], 2e-6, 1e-20);
  EXPECT_NEAR(ball.extent, 4e-6, 1e-20);
  EXPECT_NEAR(region("layer y-max 3", "subsection Units\n set Length = um\nend\n").extent, 3e-6, 1e-20);
}

TEST(Region, WhatMeansNothingIsRefusedWithWhatIsAllowed)
{
  for (const std::string wrong :
       {"side w-min", "side x-mid", "side z-min", "layer y-max", "layer y-max -1", "box 1, 1", "ball 1, 2",
        "ball 1, 2, 3 : 1", "material steel", "body gel", "all of it", "nearest 1", "here"})
    {
      const auto message = message_of([&] { region(wrong); });
      EXPECT_NE(message.find("test.prm:1: 'Where' was given as '" + wrong + "'; it must be one of 'side y-min'"),
                std::string::npos)
        << message;
    }
  EXPECT_NE(message_of([] { region("box 1, 0 : 0, 1"); }).find("must lie below"), std::string::npos);
}
