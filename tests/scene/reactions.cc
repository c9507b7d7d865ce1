#include "scene_of.h"

#include <stroma/scene/reactions.h>

#include <gtest/gtest.h>

#include <cmath>
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

TEST(Reactions, AMovedEndTellsStressAndModulusInTensionAndShear)
{
  const SceneOf<2>                    s(box("block", "0, 1", "2, 5"),
                                        "set Thickness = 3\nsubsection Supports\n"
                                                           " subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
                                                           " subsection top\n  set Where = side y-max\n"
                                                           "  set Displacement = .2*t; -.4*t\n end\nend\n");
  const std::vector<Force>            forces = {Force({-12., 6.}), Force({12., -6.})};
  const auto                          all    = reaction_scalars<2>(s.scene, forces, .5);
  const std::map<std::string, double> named(all.begin(), all.end());
  EXPECT_NEAR(named.at("nominal_stress_y_Pa"), -1., 1e-14); // 6 N over 2 m x 3 m
  EXPECT_NEAR(named.at("apparent_modulus_y_Pa"), 20., 1e-12);
  EXPECT_NEAR(named.at("shear_strain_xy"), .025, 1e-14);
  EXPECT_NEAR(named.at("shear_stress_xy_Pa"), 2., 1e-14);
  EXPECT_NEAR(named.at("apparent_modulus_xy_Pa"), 80., 1e-12);
  const auto at_rest = reaction_scalars<2>(s.scene, forces, 0.);
  EXPECT_TRUE(std::isnan(std::map<std::string, double>(at_rest.begin(), at_rest.end()).at("apparent_modulus_y_Pa")));

  const auto specimen = specimen_results(s.scene);
  EXPECT_EQ(specimen.at("box_y_m"), 4.);
  EXPECT_EQ(specimen.at("section_x_m2"), 12.);
  EXPECT_EQ(specimen.at("section_y_m2"), 6.);
}
