// STL files: both forms, and each way in which one is no surface of a body.

#include "stl_files.h"

#include <stroma/shapes/box.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;
  using namespace Stroma::Shapes;

  StlFiles::Facets
  cube()
  {
    return Box<3>({-.5, 0, 1.25}, {.1, 2, 3}).facets(10.);
  }

  std::string
  message(const std::string &bytes)
  {
    try
      {
        make_surface(read_stl(bytes));
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  bool
  says(const std::string &text, const std::string &part)
  {
    return text.find(part) != std::string::npos;
  }

  TEST(Stl, BothFormsHoldTheSame)
  {
    const auto binary = read_stl(StlFiles::binary(cube())), ascii = read_stl(StlFiles::ascii(cube()));
    EXPECT_EQ(binary.vertices.size(), 8u);
    EXPECT_EQ(binary.corners.size(), 12u);
    EXPECT_EQ(binary.vertices, ascii.vertices);
    EXPECT_EQ(binary.corners, ascii.corners);
    EXPECT_NEAR(make_surface(ascii)->volume(), .6 * 2 * 1.75, 1e-7);
    // The words of a binary file's header say nothing of its form.
    auto bytes = StlFiles::binary(cube());
    bytes.replace(0, 5, "solid");
    EXPECT_EQ(read_stl(bytes).corners, binary.corners);
  }

  TEST(Stl, FilesThatAreCutShortOrNone)
  {
    const auto binary = StlFiles::binary(cube()), ascii = StlFiles::ascii(cube());
    EXPECT_EQ(message(binary.substr(0, binary.size() - 7)),
              "a binary STL of 12 triangles has 684 bytes, this file has 677; it is truncated, or no STL");
    EXPECT_EQ(message(binary.substr(0, 50)), "a file of 50 bytes is no STL");
    EXPECT_TRUE(says(message(ascii.substr(0, ascii.size() / 2)), "; it is truncated"));
    EXPECT_EQ(message("solid x\n facet normal 0 0 one\n"),
              "line 2: 'one' stands where a number should; this is no STL");
    EXPECT_EQ(message("solid x\n facets\n"),
              "line 2: 'facets' stands where 'facet' or 'endsolid' should; this is no STL");
    EXPECT_EQ(message("solid x\nendsolid x\n"), "there is no triangle in it");
    auto far             = cube();
    far[3].corners[1][0] = 1e300;
    EXPECT_TRUE(says(message(StlFiles::binary(far)), "a corner of triangle 4 is not finite"));
  }

  TEST(Stl, SurfacesThatBoundNoBody)
  {
    auto facets = cube();
    EXPECT_EQ(message(StlFiles::binary(facets)), "");
    facets.pop_back();
    EXPECT_TRUE(says(message(StlFiles::binary(facets)), "belongs to 1 triangle instead of two"));
    facets = cube();
    facets.push_back({{{facets[0].corners[0], facets[0].corners[1], {7, 7, 7}}}});
    EXPECT_TRUE(says(message(StlFiles::binary(facets)), "the surface is not closed"));
    facets = cube();
    std::swap(facets[5].corners[0], facets[5].corners[1]);
    EXPECT_TRUE(says(message(StlFiles::binary(facets)), "go round in different ways"));
    facets = cube();
    for (auto &facet : facets)
      std::swap(facet.corners[0], facet.corners[1]);
    EXPECT_TRUE(says(message(StlFiles::binary(facets)), "inside out"));
    facets       = cube();
    const auto a = facets[0].corners[0], b = facets[0].corners[1];
    facets.push_back({{{a, b, a + .5 * (b - a)}}});
    EXPECT_TRUE(says(message(StlFiles::binary(facets)), "has no area"));
  }

  TEST(Stl, SurfacesThatCrossThemselves)
  {
    const auto with_another = [](const dealii::Tensor<1, 3> &offset) {
      auto facets = cube();
      for (auto facet : cube())
        {
          for (auto &corner : facet.corners)
            corner += offset;
          facets.push_back(facet);
        }
      return message(StlFiles::binary(facets));
    };
    EXPECT_TRUE(says(with_another(dealii::Point<3>(.3, .4, .5)), "the surface crosses itself at ("));
    EXPECT_EQ(with_another(dealii::Point<3>(.6, .4, .5)), ""); // they touch
    EXPECT_EQ(with_another(dealii::Point<3>(1., 0., 0.)), "");
    const auto with_corner_at = [](const dealii::Point<3> &place) {
      auto facets = cube();
      for (auto &facet : facets)
        for (auto &corner : facet.corners)
          if (corner.distance(dealii::Point<3>(-.5, 0., 1.25)) < 1e-6)
            corner = place;
      return message(StlFiles::binary(facets));
    };
    EXPECT_EQ(with_corner_at({-.2, 1., 2.}), "");
    EXPECT_TRUE(says(with_corner_at({-.3, 1.1, 4.}), "crosses itself")); // through the face at the top
  }
} // namespace
