#include "scene_of.h"

#include <stroma/scene/doubts.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  const std::string stretched = "subsection Supports\n"
                                " subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
                                " subsection top\n  set Where = side y-max\n  set Displacement = free; .1*t\n end\n"
                                "end\n";

  const std::string material = "  set Material = gel\n", other = "  set Material = stiff\n";

  std::vector<std::string>
  doubts_of(const std::string &bodies, const std::string &more)
  {
    return doubts(SceneOf<2>(bodies, more).scene);
  }
} // namespace

TEST(Doubts, AreNoneOfBodiesThatTouch)
{
  EXPECT_TRUE(doubts_of(box("block", "0, 0", "2, 5", material) + box("lid", "0, 5", "2, 6", other), stretched).empty());
}

TEST(Doubts, AreOfBodiesApartInASpecimenThatIsStrained)
{
  const auto block = box("block", "0, 0", "2, 5", material);
  const auto apart = doubts_of(block + box("lid", "6, 8", "7, 9", other), stretched);
  ASSERT_EQ(apart.size(), 1u);
  EXPECT_EQ(apart[0], "body 'lid' lies 5 m apart from 'block': no force passes between them, and strain, section and "
                      "apparent modulus are those of the box around all bodies");
  EXPECT_EQ(doubts_of(block + box("lid", "6, 8", "7, 9", other) + box("arm", "2, 4", "6, 8", other), stretched).size(),
            0u); // a third one joins them
  EXPECT_EQ(doubts_of(block + box("lid", "6, 8", "7, 9", other), "").size(), 0u);
}

TEST(Doubts, AreOfDrivenSidesWhoseEdgesAnotherSupportHoldsAlongThem)
{
  const auto block   = box("block", "0, 0", "2, 5", material) + box("lid", "0, 5", "2, 6", other);
  const auto left_as = [&](const std::string &entries) {
    return doubts_of(block, "subsection Supports\n subsection left\n  set Where = side x-min\n  set Displacement = " +
                              entries + "\n end\n subsection top\n  set Where = side y-max\n" +
                              "  set Displacement = .1*y*t; 0\n end\nend\n");
  };
  EXPECT_EQ(left_as("free; 0").size(), 0u);
  const auto found = left_as(".1*y*t; free");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("support 'left' holds an edge of 'top' along x too"), std::string::npos) << found[0];
}

TEST(Doubts, AreOfMaterialsOfNoBodyAndOfDensitiesInOtherUnits)
{
  const auto dense = [](const std::string &density) {
    const auto file = ParameterFile::parse("subsection Units\n set Length = um\nend\n"
                                           "subsection Materials\n subsection gel\n  set Shear modulus = 1\n"
                                           "  set Bulk modulus = 2\n  set Density = " +
                                             density + "\n end\nend\nsubsection Bodies\n" +
                                             box("block", "0, 0", "2, 5") + "end\n",
                                           "test.prm");
    Parameters parameters(file);
    return doubts(Scene<2>(parameters, MPI_COMM_WORLD));
  };
  EXPECT_EQ(dense("1e-15").size(), 0u); // kg/um^3
  ASSERT_EQ(dense("1000").size(), 1u);
  EXPECT_EQ(dense("1000")[0],
            "test.prm:5: material 'gel' has a density of 1e+21 kg/m^3; 'Density' counts in the file's units of "
            "mass and length");
  EXPECT_EQ(doubts_of(box("block", "0, 0", "2, 5", material), ""),
            std::vector<std::string>{"no body is made of material 'stiff'"});
}
