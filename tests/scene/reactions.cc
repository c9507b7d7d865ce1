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

TEST(Reactions, NothingIsStrainedAtTheStartWhateverIsPrescribed)
{
  const SceneOf<2> s(box("block", "0, 1", "2, 5"),
                     section("Supports", "top", "  set Where = side y-max\n  set Displacement = free; .4*cos(t)\n"));
  const auto       all   = reaction_scalars<2>(s.scene, {Force()}, 0.);
  auto             named = std::map<std::string, double>(all.begin(), all.end());
  EXPECT_EQ(named.at("strain_y"), 0.);
  EXPECT_TRUE(is_modulus_at_rest("apparent_modulus_y_Pa", named.at("apparent_modulus_y_Pa")));
}

TEST(Reactions, StrainIsThatOfBothEndsAtTheirMiddle)
{
  EXPECT_NEAR(scalars("side y-min").at("strain_y"), (.4 * .5 + .01) / 4., 1e-14);
  EXPECT_EQ(scalars("side y-min").count("strain_x"), 0u);
}

namespace
{
  /// Of a block of 2 by 4 with two supports that bear forces of 1 and 10 along both axes, at t = 1.
  std::map<std::string, double>
  of_two(const std::string &first, const std::string &second)
  {
    const SceneOf<2> s(box("block", "0, 1", "2, 5"), "subsection Supports\n subsection first\n" + first +
                                                       " end\n subsection second\n" + second + " end\nend\n");
    const auto       all = reaction_scalars<2>(s.scene, {Force({1., 1.}), Force({10., 10.})}, 1.);
    return {all.begin(), all.end()};
  }
} // namespace

TEST(Reactions, EndsAreSidesLayersAndBoxesThatTakeThemIn)
{
  const std::string clamp = "  set Type = clamp\n", lower = "  set Where = side y-min\n" + clamp,
                    upper = "  set Where = side y-max\n" + clamp;
  const auto at_lower_end = [&](const std::string &where) {
    return of_two(lower, "  set Where = " + where + "\n" + clamp).at("reaction_force_y_N");
  };
  EXPECT_EQ(at_lower_end("box -1, 0 : 3, 2"), 11.);
  EXPECT_EQ(at_lower_end("layer y-min 1"), 11.);
  EXPECT_EQ(at_lower_end("box -1, 2 : 3, 3"), 1.);
  EXPECT_EQ(at_lower_end("box -1, 2 : 3, 9"), 1.); // the other end
  EXPECT_EQ(at_lower_end("box -1, 0 : 3, 9"), 1.); // both
  const auto pulled = [&](const std::string &where) {
    return of_two("  set Where = side y-max\n  set Displacement = free; t\n", "  set Where = " + where + "\n" + clamp)
      .at("nominal_stress_y_Pa");
  };
  EXPECT_EQ(pulled("box -1, 4 : 3, 9"), 5.5);
  EXPECT_EQ(pulled("box -1, 0 : 3, 9"), .5);
}

TEST(Reactions, StrainIsOfWhatEndsPrescribe)
{
  const std::string held   = "  set Type = clamp\n";
  const auto        strain = [&](const std::string &first, const std::string &second) {
    const auto all   = of_two(first, second);
    const auto found = all.find("strain_y");
    return found == all.end() ? -1. : found->second;
  };
  EXPECT_EQ(strain("  set Where = layer y-max 1\n  set Displacement = free; t\n", "  set Where = side y-min\n" + held),
            .25);
  EXPECT_EQ(strain("  set Where = side y-max\n  set Displacement = 0; y\n", "  set Where = side x-min\n" + held),
            1.25); // at y = 5
  EXPECT_EQ(strain("  set Where = side y-max\n  set Displacement = 0; free\n", "  set Where = side y-min\n" + held),
            -1.);
  // Only what moves has a modulus, and only that of nothing is at rest.
  EXPECT_EQ(of_two("  set Where = side y-max\n  set Displacement = free; 1\n", "  set Where = side y-min\n" + held)
              .count("apparent_modulus_y_Pa"),
            0u);
  EXPECT_TRUE(is_modulus_at_rest("apparent_modulus_y_Pa", std::nan("")));
  EXPECT_FALSE(is_modulus_at_rest("apparent_modulus_y_Pa", 1.) || is_modulus_at_rest("strain_y", std::nan("")));
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
