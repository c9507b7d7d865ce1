#include "scene_of.h"

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  const std::string block = box("block", "0, 0", "1, 1");

  Support<2>
  support(const std::string &entries)
  {
    return SceneOf<2>(block, section("Supports", "s", entries)).scene.supports[0];
  }

  std::string
  refused(const std::string &list, const std::string &entries)
  {
    return message_of([&] { SceneOf<2>(block, section(list, "s", entries)); });
  }
} // namespace

TEST(Boundary, TypesOfSupportsHoldTheirComponents)
{
  const auto clamp = support("  set Where = side y-min\n  set Type = clamp\n");
  EXPECT_TRUE(clamp.holds(0) && clamp.holds(1) && clamp.holds_rotation);
  const auto symmetry = support("  set Where = side y-min\n  set Type = symmetry\n");
  EXPECT_FALSE(symmetry.holds(0));
  EXPECT_TRUE(symmetry.holds(1));
  const auto slide = support("  set Where = all\n  set Displacement = x*t; free\n");
  EXPECT_TRUE(slide.holds(0));
  EXPECT_FALSE(slide.holds(1));
  EXPECT_EQ(slide.displacement.value({.5, 0.}, 3., 0), 1.5);
  const auto flow = support("  set Where = all\n  set Type = velocity\n  set Velocity = free; 2\n");
  EXPECT_FALSE(flow.holds(0));
  EXPECT_TRUE(flow.holds(1));
}

TEST(Boundary, SupportsThatHoldNothingAreRefused)
{
  EXPECT_NE(refused("Supports", "  set Where = all\n  set Displacement = free; free\n").find("holds nothing"),
            std::string::npos);
  EXPECT_NE(refused("Supports", "  set Where = all\n").find("'Displacement' is missing"), std::string::npos);
  EXPECT_NE(refused("Supports", "  set Where = all\n  set Type = symmetry\n").find("'symmetry' needs a side"),
            std::string::npos);
  EXPECT_NE(refused("Supports", "  set Where = all\n  set Displacement = 0; 0\n  set Rotation = t\n")
              .find("turns a rigid body"),
            std::string::npos);
}

TEST(Boundary, ALoadHasOneAmountThatFitsItsPlace)
{
  const std::string side = "  set Where = side x-max\n", all = "  set Where = all\n",
                    point = "  set Where = nearest 1, 1\n", traction = "  set Traction = 1; 0\n",
                    density = "  set Force density = 1; 0\n", total = "  set Total force = 1; 0\n";
  for (const auto &fits : {side + traction, side + total, all + density, all + total, point + total})
    EXPECT_EQ(refused("Loads", fits), "");
  EXPECT_NE(refused("Loads", side + density).find("has no volume"), std::string::npos);
  EXPECT_NE(refused("Loads", all + traction).find("a traction acts on a 'side'"), std::string::npos);
  EXPECT_NE(refused("Loads", point + density).find("needs 'Total force'"), std::string::npos);
  EXPECT_NE(refused("Loads", all + "  set Torque = 1\n").find("'Torque' turns a rigid body"), std::string::npos);
  for (const auto &wrong : {all, all + density + total})
    EXPECT_NE(refused("Loads", wrong).find("one of them"), std::string::npos);
}
