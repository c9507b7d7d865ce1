// Where particles are at the start: counts, volumes, layers, lattices, jitter, materials.

#include "../base/keep_largest.h"
#include "../world.h"
#include "scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace
{
  using namespace Stroma;
  using Particles::ArrangementName;

  unsigned int
  n_all(const unsigned int n)
  {
    return dealii::Utilities::MPI::sum(n, world);
  }

  template <int dim>
  double
  free_volume(const Particles::ParticleSet<dim> &particles)
  {
    double sum = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      sum += particles.V0[i];
    return dealii::Utilities::MPI::sum(sum, world);
  }

  /// Number of particles of each mover, on all ranks.
  template <int dim>
  std::map<unsigned int, unsigned int>
  n_of_movers(const Particles::ParticleSet<dim> &particles, const unsigned int n_movers)
  {
    std::map<unsigned int, unsigned int> n;
    for (unsigned int m = 0; m < n_movers; ++m)
      n[m] = n_all(std::count(particles.mover.begin() + particles.n_free, particles.mover.end(), m));
    return n;
  }

  /// Number of free particles at distances up to (1 + 1e-9) @p reach of each one, in a scene that repeats every way.
  template <int dim>
  std::vector<unsigned int>
  n_neighbours(const Particles::ParticleSet<dim> &particles, const dealii::BoundingBox<dim> &box, const double reach)
  {
    std::vector<unsigned int> n(particles.n_free, 0);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (unsigned int j = 0; j < particles.n_free; ++j)
        {
          auto r = particles.x[i] - particles.x[j];
          for (unsigned int d = 0; d < dim; ++d)
            r[d] -= box.side_length(d) * std::round(r[d] / box.side_length(d));
          n[i] += i != j && r.norm() <= reach * (1. + 1e-9);
        }
    return n;
  }

  TEST(Arrangement, MpiTractionsInsideFourHeldSides)
  {
    for (const double spacing : {.05, .025})
      {
        auto               s         = ParticleScene<2>::heck("tractions");
        const unsigned int n         = std::lround(2. / spacing);
        const auto         particles = s.arrange(spacing, 2.6 * spacing);
        EXPECT_EQ(n_all(particles.n_free), n * n);
        EXPECT_NEAR(free_volume(particles), 4., 1e-12);
        // Three rows on each side, corners included: they belong to left and right, which come first.
        EXPECT_EQ(n_all(particles.n_owned - particles.n_free), (n + 6) * (n + 6) - n * n);
        const auto of_mover = n_of_movers(particles, 4);
        EXPECT_EQ(of_mover.at(0), 3 * (n + 6));
        EXPECT_EQ(of_mover.at(1), 3 * (n + 6));
        EXPECT_EQ(of_mover.at(2), 3 * n);
        EXPECT_EQ(of_mover.at(3), 3 * n);
        for (unsigned int i = particles.n_free; i < particles.n_owned; ++i)
          {
            EXPECT_LT(s.movers[particles.mover[i]].distance(s.scene, particles.X[i]), -.49 * spacing);
            EXPECT_GT(s.movers[particles.mover[i]].distance(s.scene, particles.X[i]), -2.6 * spacing);
          }
      }
  }

  TEST(Arrangement, MpiTractionsAtTheMicrometreScale)
  {
    auto       s         = ParticleScene<2>::heck("tractions", {"Constants/length=1e-4"});
    const auto particles = s.arrange(2.5e-6, 6.5e-6);
    EXPECT_EQ(n_all(particles.n_free), 6400u);
    EXPECT_EQ(n_all(particles.n_owned), 86u * 86u);
    EXPECT_NEAR(free_volume(particles), 4e-8, 1e-20);
  }

  TEST(Arrangement, MpiPillarsRepeatAlongX)
  {
    auto       s         = ParticleScene<2>::heck("pillars");
    const auto particles = s.arrange(1e-4, 2.6e-4);
    EXPECT_EQ(n_all(particles.n_free), 100u * 100u - 40u * 40u);
    EXPECT_NEAR(free_volume(particles), 1e-4 - 16e-6, 1e-16);
    const auto of_mover = n_of_movers(particles, 3);
    EXPECT_EQ(of_mover.at(0), 300u); // no layers and no corners beyond the periodic faces
    EXPECT_EQ(of_mover.at(1), 300u);
    EXPECT_EQ(of_mover.at(2), 40u * 40u - 34u * 34u); // depths .5, 1.5 and 2.5 spacings
    EXPECT_EQ(s.movers[2].name, "pillar");
    EXPECT_NEAR(s.movers[2].distance(s.scene, {3e-3, 1e-3}), 1e-3, 1e-15);
    EXPECT_NEAR(s.movers[2].distance(s.scene, {0., 1.5e-3}), -5e-4, 1e-15);
  }

  TEST(Arrangement, MpiPillarsHexagonal)
  {
    auto       s         = ParticleScene<2>::heck("pillars");
    const auto particles = s.arrange(1e-4, 2.6e-4, ArrangementName::hexagonal);
    const auto of_mover  = n_of_movers(particles, 3);
    EXPECT_EQ(of_mover.at(0), 100u * 3u); // 115 rows, 8.696e-5 m apart
    EXPECT_EQ(of_mover.at(1), 100u * 3u);
    EXPECT_NEAR(free_volume(particles), 1e-4 - 16e-6, 4e-7);
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      EXPECT_LT(std::abs(particles.X[i][0]), 5e-3);
  }

  // Drawn across the periodic face, it takes up what it does inside: on either side of that face.
  TEST(Arrangement, MpiRigidBodyGoesOnAcrossAPeriodicFace)
  {
    const auto of_disc_at = [](const std::string &x, const ArrangementName name) {
      ParticleScene<2> s(box_of_gel("1, 1", clamped({"y-min"}) + "subsection Periodic\n set Directions = x\nend\n",
                                    " subsection disc\n  set Shape = ball\n  set Rigid = true\n  set Radius = 0.21\n"
                                    "  set Centre = " +
                                      x + ", 0.5\n end\n"));
      auto             particles = s.arrange(.05, .05, name);
      for (unsigned int i = particles.n_free; i < particles.n_owned; ++i)
        if (s.movers[particles.mover[i]].rigid)
          {
            EXPECT_LT(s.movers[particles.mover[i]].distance(s.scene, particles.X[i]), 0.) << x;
          }
      return std::make_pair(n_of_movers(particles, 2), std::make_pair(n_all(particles.n_free), free_volume(particles)));
    };
    for (const auto name : {ArrangementName::square, ArrangementName::hexagonal, ArrangementName::voronoi})
      {
        const auto inside = of_disc_at("0.5", name);
        for (const std::string x : {"0", "1", "-0.5", "2"})
          {
            const auto across = of_disc_at(x, name);
            EXPECT_EQ(across.first, inside.first) << x;
            EXPECT_EQ(across.second.first, inside.second.first) << x;
            EXPECT_NEAR(across.second.second, inside.second.second, 1e-12) << x;
          }
        EXPECT_NEAR(inside.second.second, 1. - M_PI * .21 * .21, 1e-3);
      }
  }

  TEST(Arrangement, CornerWithFreeSideIsNotFilled)
  {
    ParticleScene<2> s(box_of_gel("1, 1", clamped({"y-min", "x-min"})));
    const auto       particles = s.arrange(.1, .25);
    const auto       of_mover  = n_of_movers(particles, 2);
    EXPECT_EQ(of_mover.at(0), 39u); // 13 columns: over the corner at x-min, not beyond x-max
    EXPECT_EQ(of_mover.at(1), 30u);
    EXPECT_EQ(particles.material.size(), particles.size());
  }

  TEST(Arrangement, LayerOnlyWhereTheBodyIs)
  {
    ParticleScene<2> s(
      scene_of(hypoelastic("gel", 1., .3),
               " subsection wedge\n  set Shape = quadrilateral\n  set Corners = 0, 0, 1, 0, 1, 1, 0, 0.5\n end\n",
               clamped({"x-min"})));
    const auto particles = s.arrange(.1, .2);
    EXPECT_NEAR(free_volume(particles), .75, 1e-14);
    EXPECT_EQ(particles.n_owned - particles.n_free, 2u * 5u);
  }

  TEST(Arrangement, MpiCube)
  {
    ParticleScene<3> s(box_of_gel("1, 1, 1", clamped({"z-min", "x-max"})));
    const auto       particles = s.arrange(.1, .2);
    EXPECT_EQ(n_all(particles.n_free), 1000u);
    EXPECT_NEAR(free_volume(particles), 1., 1e-13);
    const auto of_mover = n_of_movers(particles, 2);
    EXPECT_EQ(of_mover.at(0), 2u * 12u * 10u);
    EXPECT_EQ(of_mover.at(1), 2u * 10u * 10u);
  }

  TEST(Arrangement, HexagonalHasSixEqualNeighbours)
  {
    ParticleScene<2> s(box_of_gel("1, 10*sqrt(3)/20", "subsection Periodic\n set Directions = x, y\nend\n"));
    const auto       particles = s.arrange(.1, 0., ArrangementName::hexagonal);
    ASSERT_EQ(particles.n_free, 100u);
    for (const auto n : n_neighbours(particles, s.scene.bounding_box(), .1))
      EXPECT_EQ(n, 6u);
  }

  TEST(Arrangement, ClosePackingHasTwelveEqualNeighbours)
  {
    ParticleScene<3> s(
      box_of_gel("0.6, 0.6*sqrt(3)/2, 0.6*sqrt(2/3)", "subsection Periodic\n set Directions = x, y, z\nend\n"));
    const auto particles = s.arrange(.1, 0., ArrangementName::hexagonal);
    ASSERT_EQ(particles.n_free, 216u);
    for (const auto n : n_neighbours(particles, s.scene.bounding_box(), .1))
      EXPECT_EQ(n, 12u);
  }

  TEST(Arrangement, MpiVolumesOfCurvedBodiesAreExact)
  {
    const auto       gel = hypoelastic("gel", 1., .3);
    ParticleScene<2> ring(scene_of(gel, " subsection ring\n  set Shape = ring\n  set Inner radius = 1\n"
                                        "  set Outer radius = 2\n  set Angles = 0, 90\n end\n"));
    EXPECT_NEAR(free_volume(ring.arrange(.1)), .75 * dealii::numbers::PI, 1e-12);
    EXPECT_NEAR(free_volume(ring.arrange(.1, 0., ArrangementName::voronoi)), .75 * dealii::numbers::PI, 1e-12);
    ParticleScene<3> ball(scene_of(gel, " subsection ball\n  set Shape = ball\n  set Radius = 1\n end\n"));
    EXPECT_NEAR(free_volume(ball.arrange(.2)), 4. / 3. * dealii::numbers::PI, 1e-12);
  }

  TEST(Arrangement, MpiTwoMaterials)
  {
    ParticleScene<2> s(
      box_of_gel("1, 1", "",
                 " subsection inclusion\n  set Shape = ball\n  set Centre = 0.5, 0.5\n  set Radius = 0.3\n"
                 "  set Material = stiff\n end\n"));
    for (const auto name : {ArrangementName::square, ArrangementName::hexagonal, ArrangementName::voronoi})
      {
        const auto particles = s.arrange(.025, 0., name);
        double     stiff     = 0.;
        for (unsigned int i = 0; i < particles.n_free; ++i)
          {
            EXPECT_EQ(particles.material[i], particles.X[i].distance({.5, .5}) <= .3 ? 1 : 0);
            stiff += particles.material[i] * particles.V0[i];
          }
        EXPECT_NEAR(free_volume(particles), 1., 1e-12);
        EXPECT_NEAR(dealii::Utilities::MPI::sum(stiff, world), .09 * dealii::numbers::PI, 1e-12);
      }
  }

  TEST(Arrangement, MpiJitterIsBoundedAndTheSameOnAnyRanks)
  {
    ParticleScene<2> s(box_of_gel("1, 1", clamped({"x-min"})));
    const auto       regular = s.arrange(.1, .2), shaken = s.arrange(.1, .2, ArrangementName::square, .5);
    ASSERT_EQ(regular.id, shaken.id);
    double largest = 0.;
    for (unsigned int i = 0; i < shaken.size(); ++i)
      {
        EXPECT_TRUE(shaken.is_fixed(i) || s.scene.material_at(shaken.X[i]));
        EXPECT_TRUE(!shaken.is_fixed(i) || shaken.X[i] == regular.X[i]);
        for (unsigned int d = 0; d < 2; ++d)
          keep_largest(largest, std::abs(shaken.X[i][d] - regular.X[i][d]));
      }
    EXPECT_LE(largest, .05 + 1e-15);
    EXPECT_GT(dealii::Utilities::MPI::max(largest, world), .045);
    EXPECT_TRUE(are_share_of(shaken, s.arrange_alone(.1, .2, ArrangementName::square, .5)));
  }

  TEST(Arrangement, UnfitSpacingAndEmptyBodies)
  {
    const auto message = [](const std::string &text, const double spacing) {
      try
        {
          ParticleScene<2>(text).arrange(spacing);
        }
      catch (const UserError &error)
        {
          return std::string(error.what());
        }
      return std::string();
    };
    EXPECT_EQ(
      message(box_of_gel("1, 0.13"), .1),
      "particles 0.1 m apart do not fit bodies that are 0.13 m long along y: 1.3 rows would have to move by more "
      "than 25 % of their distance; change 'Spacing'");
    EXPECT_NE(message(box_of_gel("1, 0.04"), .1), "");
    EXPECT_EQ(message(box_of_gel("1, 0.12"), .1), "");
    EXPECT_NE(message(box_of_gel("1, 1"), 1e-6).find("use a larger 'Spacing'"), std::string::npos);
    EXPECT_NE(
      message(box_of_gel("1, 1", "",
                         " subsection dot\n  set Shape = ball\n  set Radius = 0.01\n  set Centre = 0.5, 0.5\n end\n"),
              .1)
        .find("body 'dot' holds no particle of spacing 0.1 m"),
      std::string::npos);
  }
} // namespace
