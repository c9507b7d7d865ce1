#include "scene_of.h"

#include <stroma/scene/reactions.h>

#include <gtest/gtest.h>

#include <map>

using namespace Stroma;

namespace
{
  using Force = dealii::Tensor<1, 2>;

  std::map<std::string, double>
  scalars(const std::string &lower)
  {
    const SceneOf<2> s(box("block", "0, 1", "2, 5"),
                       "subsection Supports\n"
                       " subsection bottom\n  set Where = " +
                         lower +
                         "\n  set Type = clamp\n end\n"
                         " subsection edge\n  set Where = layer y-min .5\n  set Displacement = free; 0\n end\n"
                         " subsection top\n  set Where = side y-max\n  set Displacement = free; .4*t + x/100\n end\n"
                         "end\n");
    const auto       all = reaction_scalars<2>(s.scene, {Force({-1., -5.}), Force({0., 2.}), Force({0., 3.})}, .5);
    return {all.begin(), all.end()};
  }
} // namespace

TEST(Reactions, AreNamedByWhatEachSupportHolds)
{
  const auto named = scalars("side y-min");
  EXPECT_EQ(named.at("reaction_bottom_x_N"), -1.);
  EXPECT_EQ(named.at("reaction_bottom_y_N"), -5.);
  EXPECT_EQ(named.at("reaction_edge_y_N"), 2.);
  EXPECT_EQ(named.count("reaction_edge_x_N"), 0u);
  EXPECT_EQ(named.at("reaction_top_y_N"), 3.);
}

TEST(Reactions, TheHeadlineIsTheSumAtAHeldLowerSide)
{
  EXPECT_EQ(scalars("side y-min").at("reaction_force_y_N"), 3.);
  EXPECT_EQ(scalars("side x-max").count("reaction_force_y_N"), 0u); // a layer alone is no side
}

TEST(Reactions, StrainIsThatOfBothEndsAtTheirMiddle)
{
  EXPECT_NEAR(scalars("side y-min").at("strain_y"), (.4 * .5 + .01) / 4., 1e-14);
  EXPECT_EQ(scalars("side y-min").count("strain_x"), 0u);
}
