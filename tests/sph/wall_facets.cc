// Walls of facets: what particles see of them, and the balance of uniform stress beside them.

#include "../base/keep_largest.h"
#include "../particles/scene_fixture.h"

#include <stroma/sph/system.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;
  using dealii::Point;
  using dealii::Tensor;

  const double dp = .05;

  std::string
  gel(const std::string &bodies, const std::string &more = "")
  {
    return scene_of(hypoelastic("gel", 1., .3, "  set Density = 1\n  set Viscosity = 1\n"), bodies, more);
  }

  std::string
  box(const std::string &name, const double y0, const double y1, const bool rigid)
  {
    return " subsection " + name + "\n  set Shape = box\n  set Lower corner = 0, " + std::to_string(y0) +
           "\n  set Upper corner = 1, " + std::to_string(y1) + "\n  set Rigid = " + (rigid ? "true" : "false") +
           "\n end\n";
  }

  template <int dim>
  struct Walled
  {
    explicit Walled(const std::string &text, const Sph::ArrangementName name = Sph::ArrangementName::square,
                    const double jitter = 0.)
      : fixture(text)
    {
      settings.arrangement.spacing = dp;
      settings.arrangement.name    = name;
      settings.arrangement.jitter  = jitter;
      settings.walls               = Sph::Walls::facets;
      system = std::make_unique<Sph::System<dim>>(fixture.scene, settings, Sph::Dynamics::overdamped, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
    }

    /// Largest force of a uniform stress of 1 on a particle, over a spacing to the power of dim - 1.
    double
    largest_force() const
    {
      const auto &pairs   = system->pairs;
      double      largest = 0.;
      for (unsigned int i = 0; i < system->particles.n_free; ++i)
        {
          Tensor<1, dim> sum;
          for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
            sum += (p < pairs.row_fixed[i] ? 1. : .5) * pairs.c[p];
          keep_largest(largest, sum.norm());
        }
      return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD) / std::pow(dp, dim - 1);
    }

    /// The area of mover @p m that particles have between them.
    Tensor<1, dim>
    area(const unsigned int m) const
    {
      const auto    &pairs = system->pairs;
      Tensor<1, dim> sum;
      for (unsigned int i = 0; i < system->particles.n_free; ++i)
        for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
          if (pairs.wall(p).mover == m)
            sum += .5 * pairs.c[p];
      return dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
    }

    ParticleScene<dim>                fixture;
    Sph::Settings                     settings;
    Timers                            timers;
    std::unique_ptr<Sph::System<dim>> system;
  };

  // Between rigid boxes, the upper one farther off than where the material ends.
  TEST(WallFacets, MpiUniformStressIsBalancedAtAnyGapAndTheReactionExact)
  {
    for (const auto name : {Sph::ArrangementName::square, Sph::ArrangementName::hexagonal})
      for (const double jitter : {0., .3})
        for (const double gap : {.5, .75, 1., 1.3, 1.5})
          {
            const double row = (name == Sph::ArrangementName::square ? 1. : std::sqrt(.75)) * dp, above = 19. * row,
                         face = above + (gap - .5) * dp;
            const Walled<2> walled(gel(box("floor", 0., 3. * row, true) + box("block", 3. * row, above, false) +
                                         box("roof", face, 24. * row, true),
                                       "subsection Periodic\n set Directions = x\nend\n"),
                                   name, jitter);
            EXPECT_LT(walled.largest_force(), 1e-3) << gap << ", " << jitter;
            for (unsigned int m = 0; m < 2; ++m)
              {
                const double exact = m == 0 ? -1. : 1.;
                EXPECT_NEAR(walled.area(m)[1], exact, 1e-3) << gap << ", " << jitter;
                EXPECT_NEAR(walled.area(m)[0], 0., 1e-3);
              }
          }
  }

  std::string
  held(const std::string &sides)
  {
    std::string supports = "subsection Supports\n";
    for (std::size_t k = 0; k + 5 <= sides.size(); k += 6)
      supports += " subsection " + sides.substr(k, 5) + "\n  set Where = side " + sides.substr(k, 5) +
                  "\n  set Type = clamp\n end\n";
    return supports + "end\n";
  }

  // Corners of sides, and bodies inside.
  TEST(WallFacets, MpiUniformStressIsBalancedInCornersAndBesideCurvedBodies)
  {
    const std::string all = held("x-min x-max y-min y-max"), block = box("block", 0., 1., false);
    for (
      const std::string body :
      {"",
       " subsection disc\n  set Shape = ball\n  set Centre = 0.5, 0.5\n  set Radius = 0.22\n  set Rigid = true\n end\n",
       " subsection pillar\n  set Shape = box\n  set Lower corner = 0.3, 0.3\n  set Upper corner = 0.7, 0.7\n  set Rigid = true\n end\n"})
      for (const double jitter : {0., .1})
        EXPECT_LT(Walled<2>(gel(block + body, all), Sph::ArrangementName::square, jitter).largest_force(), 1e-3)
          << body << jitter;
  }

  // An affine motion of all sides so gives each the exact reaction.
  TEST(WallFacets, MpiSidesThatMeetInCornersHaveTheirOwnAreas)
  {
    for (const double jitter : {0., .1})
      {
        const Walled<2> walled(gel(box("block", 0., 1., false), held("x-min x-max y-min y-max")),
                               Sph::ArrangementName::square, jitter);
        for (unsigned int m = 0; m < 4; ++m)
          {
            const auto         area = walled.area(m);
            const unsigned int axis = walled.fixture.movers[m].axis;
            EXPECT_NEAR(std::abs(area[axis]), 1., 1e-3) << m << ", " << jitter;
            EXPECT_NEAR(area[1 - axis], 0., 1e-14) << m << ", " << jitter;
          }
      }
  }

  TEST(WallFacets, MpiUniformStressIsBalancedInACube)
  {
    const std::string cube = " subsection block\n  set Shape = box\n  set Upper corner = 0.5, 0.5, 0.5\n end\n";
    const Walled<3>   walled(gel(cube, held("x-min x-max y-min y-max z-min z-max")));
    EXPECT_LT(walled.largest_force(), 1e-3);
    for (unsigned int m = 0; m < 6; ++m)
      EXPECT_NEAR(walled.area(m).norm(), .25, 2e-3);
  }

  /// What the particle nearest to @p x sees: mover, gap and normal of each part.
  std::vector<typename Particles::WallFacets<2>::Part>
  seen(const std::string &text, const Point<2> &x, double &missing, const Tensor<1, 2> &moved = {})
  {
    const ParticleScene<2>      fixture(text);
    Particles::WallFacets<2>    facets(fixture.scene, fixture.movers, Sph::KernelName::wendland_c2, 1.3 * dp, dp);
    std::vector<Rigid::Pose<2>> poses;
    for (const auto &mover : fixture.movers)
      poses.push_back(mover.rigid ? mover.rigid->pose(0.) : Rigid::Pose<2>());
    for (auto &pose : poses)
      pose.translation += moved;
    facets.update(0., poses);
    std::vector<typename Particles::WallFacets<2>::Part> parts;
    missing = facets.look(x, parts);
    return parts;
  }

  TEST(WallFacets, PartsAreWhatIsNearlyFlatOfAWall)
  {
    double            missing = 0.;
    const std::string block   = box("block", 0., 1., false);
    auto              parts   = seen(gel(block, held("x-min y-min")), {.5 * dp, .7 * dp}, missing);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR(parts[0].X[0], 0., 1e-15);
    EXPECT_NEAR(parts[1].X[1], 0., 1e-15);
    EXPECT_NEAR(parts[0].to[0], -.5 * dp, 1e-15);
    EXPECT_GT(missing, .3);
    EXPECT_LT(missing, .6);

    const std::string disc =
      " subsection disc\n  set Shape = ball\n  set Centre = 0.5, 0.5\n  set Radius = 0.3\n  set Rigid = true\n end\n";
    parts = seen(gel(block + disc), {.83, .5}, missing);
    ASSERT_EQ(parts.size(), 1u);
    EXPECT_NEAR(parts[0].X[0], .8, 1e-4);
    EXPECT_NEAR(parts[0].gradient[1] / parts[0].gradient[0], 0., 2e-3);

    // A body on a side: the side ends where the body stands.
    const std::string pillar =
      " subsection pillar\n  set Shape = box\n  set Lower corner = 0.4, 0\n  set Upper corner = 0.6, 0.5\n  set Rigid = true\n end\n";
    parts = seen(gel(block + pillar, held("y-min")), {.4 - .5 * dp, .5 * dp}, missing);
    ASSERT_EQ(parts.size(), 2u);
    double of_corner = 0.;
    seen(gel(block, held("x-min y-min")), {.5 * dp, .5 * dp}, of_corner);
    EXPECT_NEAR(missing, of_corner, 1e-12);
    // Two bodies that share a face have it once.
    const std::string twin =
      " subsection twin\n  set Shape = box\n  set Lower corner = 0.4, 0\n  set Upper corner = 0.6, 0.3\n  set Rigid = true\n end\n";
    EXPECT_EQ(seen(gel(block + pillar + twin, held("y-min")), {.4 - .5 * dp, .5 * dp}, missing).size(), 2u);
    EXPECT_NEAR(missing, of_corner, 1e-12);
  }

  TEST(WallFacets, ABodyIsSeenHoweverManyPeriodsItHasMoved)
  {
    const std::string disc =
      " subsection disc\n  set Shape = ball\n  set Centre = 0.5, 0.5\n  set Radius = 0.2\n  set Rigid = true\n end\n";
    const std::string text = gel(box("block", 0., 1., false) + disc, "subsection Periodic\n set Directions = x\nend\n");
    double            there = 0., now = 0.;
    const auto        at_start = seen(text, {.71, .5}, there);
    ASSERT_EQ(at_start.size(), 1u);
    EXPECT_GT(there, .1);
    for (const double way : {.6, 1.4, 2., 7.3, -3.8})
      {
        Point<2> x(.71 + way, .5);
        x[0] -= std::floor(x[0]);
        const auto parts = seen(text, x, now, Point<2>(way, 0.));
        ASSERT_EQ(parts.size(), 1u) << way;
        EXPECT_NEAR(now, there, 1e-9) << way;
        EXPECT_NEAR((parts[0].to - at_start[0].to).norm(), 0., 1e-9) << way;
      }
  }

  // A box across the periodic face touches the material there all the same: nothing is a gap.
  TEST(WallFacets, AcrossAPeriodicFaceTheMaterialIsNoFartherOff)
  {
    const auto pillar = [](const std::string &x0, const std::string &x1) {
      return " subsection pillar\n  set Shape = box\n  set Lower corner = " + x0 + ", 0.4\n  set Upper corner = " + x1 +
             ", 0.6\n  set Rigid = true\n end\n";
    };
    const std::string periodic = "subsection Periodic\n set Directions = x\nend\n";
    const Walled<2>   inside(gel(box("block", 0., 1., false) + pillar("0.3", "0.7"), periodic));
    const Walled<2>   across(gel(box("block", 0., 1., false) + pillar("-0.2", "0.2"), periodic));
    EXPECT_NEAR(across.largest_force(), inside.largest_force(), 1e-3);
    EXPECT_EQ(across.system->pairs.walls.size(), inside.system->pairs.walls.size());
    const auto                    &fixture = across.fixture;
    const Particles::WallFacets<2> facets(fixture.scene, fixture.movers, Sph::KernelName::wendland_c2, 1.3 * dp, dp);
    for (const auto &wall : across.system->pairs.walls)
      EXPECT_EQ(facets.clearance(wall.X), 0.);
  }
} // namespace
