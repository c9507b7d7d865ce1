#include "scene_of.h"

#include <stroma/scene/body_part.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  constexpr double pi = dealii::numbers::PI;

  /// A body of the shape that @p entries say.
  std::string
  shape(const std::string &entries)
  {
    return " subsection body\n" + entries + " end\n";
  }

  /// What all cells of a lattice of n cells a side over [0, 2]^2 hold of body @p b.
  BodyPart<2>
  sum_over_lattice(const Scene<2> &scene, const unsigned int b, const unsigned int n)
  {
    BodyPart<2>  all;
    const double h = 2. / n;
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = 0; j < n; ++j)
        {
          const dealii::Point<2> lower(i * h, j * h), upper((i + 1) * h, (j + 1) * h);
          const auto             part = part_in(scene, b, lower, upper);
          all.whole += part.whole;
          all.visible += part.visible;
          all.centroid += part.visible * part.centroid;
        }
    all.centroid /= all.visible;
    return all;
  }
} // namespace

TEST(BodyPart, VolumesAreThoseOfGeometry)
{
  const SceneOf<2> ring(
    shape("  set Shape = ring\n  set Inner radius = 1\n  set Outer radius = 3\n  set Angles = 0, 90\n"));
  EXPECT_NEAR(volume_of(ring.scene.bodies[0]), .25 * pi * (9. - 1.), 1e-12);
  const SceneOf<2> kite(shape("  set Shape = quadrilateral\n  set Corners = 0, 0, 2, 0, 3, 2, 0, 1\n"));
  EXPECT_NEAR(volume_of(kite.scene.bodies[0]), 3.5, 1e-12);
  const SceneOf<3> ball(shape("  set Shape = ball\n  set Radius = 2\n"));
  EXPECT_NEAR(volume_of(ball.scene.bodies[0]), 4. / 3. * pi * 8., 1e-12);
}

TEST(BodyPart, BoxesAmongBoxesAreExact)
{
  const SceneOf<2> s(box("lower", "0, 0", "1, 1") + box("later", ".5, 0", "2, 1"));
  const auto       cut = part_in(s.scene, 0, {.4, .2}, {.7, .3});
  EXPECT_NEAR(cut.whole, .03, 1e-15);
  EXPECT_NEAR(cut.visible, .01, 1e-15);
  EXPECT_NEAR(cut.centroid[0], .45, 1e-12);
  EXPECT_NEAR(cut.centroid[1], .25, 1e-12);
  // Of a cell that reaches beyond the body on each side.
  const auto beyond = part_in(s.scene, 1, {.3, -1.}, {.9, .25}), above = part_in(s.scene, 1, {1.8, .5}, {2.6, 3.});
  EXPECT_NEAR(beyond.whole, .1, 1e-15);
  EXPECT_NEAR(beyond.centroid[1], .125, 1e-12);
  EXPECT_NEAR(above.whole, .1, 1e-15);
  EXPECT_NEAR(above.centroid[0], 1.9, 1e-12);
  // What is within round-off of an edge counts as on it.
  EXPECT_EQ(part_in(s.scene, 0, {1. - 1e-12, 0.}, {1.3, .1}).whole, 0.);
  EXPECT_NEAR(part_in(s.scene, 1, {.5 - 1e-12, 0.}, {.7, .1}).visible, .02, 1e-12);
}

TEST(BodyPart, AnImageHasTheVolumeOfItsVoxels)
{
  const std::vector<std::uint8_t> voxels{0, VoxelMaterials::empty, 1, 0};
  Body<3>                         image;
  image.voxels.material   = dealii::make_array_view(voxels);
  image.voxels.voxel_size = {{2., .5, 3.}};
  EXPECT_NEAR(volume_of(image), 9., 1e-12);
}

TEST(BodyPart, CurvedBodiesAreMeasuredBySamples)
{
  const SceneOf<2> s(box("block", "0, 0", "2, 2") +
                     " subsection ball\n  set Shape = ball\n  set Centre = 1.2, 1\n  set Radius = .5\n end\n");
  const double     area = pi * .25;
  const auto       ball = sum_over_lattice(s.scene, 1, 20), block = sum_over_lattice(s.scene, 0, 20);
  EXPECT_NEAR(ball.whole, area, 2e-3 * area);
  EXPECT_EQ(ball.whole, ball.visible);
  EXPECT_NEAR(ball.centroid[0], 1.2, 1e-3);
  EXPECT_NEAR(block.whole, 4., 1e-12);
  EXPECT_NEAR(block.visible + ball.visible, 4., 1e-12); // the same samples
}
