// Bodies have the volume they were drawn with, whatever the grid.

#include "fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  const double pi = dealii::numbers::PI;

  const std::string materials =
    "subsection Materials\n"
    " subsection soft\n set Law = neo-Hookean\n set Shear modulus = 1\n set Bulk modulus = 2\n end\n"
    " subsection stiff\n set Law = neo-Hookean\n set Shear modulus = 3\n set Bulk modulus = 7\n end\n"
    "end\n";

  std::string
  body(const std::string &name, const std::string &material, const std::string &entries)
  {
    return " subsection " + name + "\n" + entries + " set Material = " + material + "\n end\n";
  }

  std::string
  scene(const std::string &bodies, const std::string &mpm)
  {
    return materials + "subsection Bodies\n" + bodies + "end\nsubsection MPM\n" + mpm + "end\n";
  }

  std::string
  box(const std::string &lower, const std::string &upper)
  {
    return " set Shape = box\n set Lower corner = " + lower + "\n set Upper corner = " + upper + "\n";
  }

  /// Volume of the points, by material.
  template <int dim>
  std::vector<double>
  volumes(const SystemFixture<dim> &s)
  {
    std::vector<double> sum(2, 0.);
    for (const auto &point : s.points->handler)
      sum[s.points->material_of(point.get_properties().data())] += point.get_properties()[s.points->volume.first];
    return sum;
  }

  TEST(Points, OfABoxThatEndsWithinCellsHaveItsVolumeAndItsCentre)
  {
    SystemFixture<2> s(
      scene(body("column", "soft", box("0, 0", "0.2, 1")), " set Cells = 2, 3\n set Upper corner = 0.2, 1.3\n"));
    EXPECT_NEAR(volumes(s)[0], .2, 1e-15);
    dealii::Point<2> centre;
    for (const auto &point : s.points->handler)
      centre += point.get_properties()[0] / .2 * point.get_location();
    EXPECT_NEAR(centre[0], .1, 1e-14);
    EXPECT_NEAR(centre[1], .5, 1e-14);
  }

  TEST(Points, OfAnAlignedBoxAreThoseOfTheLattice)
  {
    SystemFixture<2> s(
      scene(body("block", "soft", box("0, 0", "0.75, 1")), " set Cells = 4, 4\n set Upper corner = 1, 1\n"));
    EXPECT_EQ(s.points->handler.n_global_particles(), 3 * 4 * 4u);
    for (const auto &point : s.points->handler)
      {
        EXPECT_EQ(point.get_properties()[0], .125 * .125);
        for (unsigned int d = 0; d < 2; ++d)
          EXPECT_EQ(std::fmod(point.get_location()[d], .125), .0625);
      }
  }

  TEST(Points, OfASheetWithAFilmThatLiesBetweenThem)
  {
    SystemFixture<2> s(
      scene(body("sheet", "soft", box("0, 0", "8, 8")) + body("film", "stiff", box("0, 3.6", "8, 4.4")),
            " set Cells = 4, 4\n"));
    EXPECT_NEAR(volumes(s)[0], 64 - 6.4, 1e-13);
    EXPECT_NEAR(volumes(s)[1], 6.4, 1e-14);
  }

  TEST(Points, OfRoundAndSlantedBodiesHaveTheirExactVolume)
  {
    SystemFixture<2> bead(scene(body("sheet", "soft", box("0, 0", "16, 16")) +
                                  body("bead", "stiff", " set Shape = ball\n set Centre = 8, 8\n set Radius = 0.9\n"),
                                " set Cells = 4, 4\n"));
    EXPECT_NEAR(volumes(bead)[1], .81 * pi, 1e-13);
    EXPECT_NEAR(volumes(bead)[0], 256 - .81 * pi, .02 * .81 * pi);

    SystemFixture<3> ball(scene(body("ball", "soft", " set Shape = ball\n set Centre = 0, 0, 0\n set Radius = 1\n"),
                                " set Cells = 5, 4, 6\n"));
    EXPECT_NEAR(volumes(ball)[0], 4. / 3. * pi, 1e-13);

    SystemFixture<2> ring(
      scene(body("ring", "soft", " set Shape = ring\n set Inner radius = 0.75\n set Outer radius = 1\n"),
            " set Cells = 7, 7\n"));
    EXPECT_NEAR(volumes(ring)[0], pi / 4 * (1 - .5625), 1e-13);

    SystemFixture<2> membrane(
      scene(body("membrane", "soft", " set Shape = quadrilateral\n set Corners = 0, 0, 48, 44, 48, 60, 0, 44\n"),
            " set Cells = 9, 11\n"));
    EXPECT_NEAR(volumes(membrane)[0], 1440, 1e-10);
  }

  TEST(Points, OfABodyThatLaterOnesCoverAreMissed)
  {
    const std::string text = scene(body("hidden", "stiff", box("1, 1", "2, 2")) +
                                     body("sheet", "soft", box("0, 0", "4, 4")),
                                   " set Cells = 4, 4\n");
    EXPECT_THROW(SystemFixture<2> s(text), UserError);
  }

  TEST(Points, AreChosenByWhereTheyWereBeforeAReset)
  {
    SystemFixture<2> s(
      scene(body("block", "soft", box("0, 0", "1, 1")), " set Cells = 4, 4\n set Grid reset = always\n") +
      "subsection Loads\n subsection pull\n set Where = layer y-max 0.25\n set Total force = 0; 1\n end\nend\n");
    const auto before = s.points->nearest({.5, .5});
    const auto u      = [&] {
      Vector u = s.system->new_vector();
      for (auto &value : u)
        value = -.3;
      return u;
    }();
    s.system->rebase_points(u, true);
    EXPECT_EQ(s.points->nearest({.5, .5}), before);
    // As a resumed run makes it: from the points where they are now.
    Mpm::System<2> resumed(s.scene, s.settings, *s.grid, *s.points, *s.motion, s.timers);
  }
} // namespace
