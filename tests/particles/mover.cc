// Motion of held sides and rigid bodies, and what particles cannot hold.

#include "scene_fixture.h"

#include <stroma/particles/rigid_step.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  std::string
  support(const std::string &entries)
  {
    return "subsection Supports\n subsection top\n" + entries + " end\nend\n";
  }

  const std::string disk = " subsection disk\n  set Shape = ball\n  set Rigid = true\n  set Centre = 0.5, 1.4\n"
                           "  set Radius = 0.4\n end\n";

  std::string
  message(const std::string &text)
  {
    try
      {
        ParticleScene<2> scene(text);
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  bool
  contains(const std::string &text, const std::string &part)
  {
    return text.find(part) != std::string::npos;
  }

  TEST(Mover, VelocityFollowsFromDisplacement)
  {
    ParticleScene<2> s(
      box_of_gel("1, 1", support("  set Where = side y-max\n  set Displacement = 0.1*x*t; sin(3*t)\n")));
    ASSERT_EQ(s.movers.size(), 1u);
    const auto            &top = s.movers[0];
    const dealii::Point<2> X(.5, 1.05);
    for (const double t : {0., 1e-7, .4, 100.})
      {
        EXPECT_NEAR(top.displacement(s.scene, X, t)[1], std::sin(3. * t), 1e-14);
        EXPECT_NEAR(top.velocity(s.scene, X, t)[0], .05, 1e-7);
        EXPECT_NEAR(top.velocity(s.scene, X, t)[1], 3. * std::cos(3. * t), 1e-7);
      }
    EXPECT_TRUE(top.gives_displacement);
    EXPECT_NEAR(top.distance(s.scene, X), -.05, 1e-15);
    EXPECT_NEAR(top.distance(s.scene, {.5, .2}), .8, 1e-15);
  }

  TEST(Mover, WallMovesInItsPlane)
  {
    ParticleScene<2> s(
      box_of_gel("1, 1", support("  set Where = side y-max\n  set Type = velocity\n  set Velocity = 2; 0\n")));
    EXPECT_FALSE(s.movers[0].gives_displacement);
    EXPECT_EQ(s.movers[0].velocity(s.scene, {.3, 1.1}, 7.)[0], 2.);
    EXPECT_EQ(s.movers[0].velocity(s.scene, {.3, 1.1}, 7.)[1], 0.);
  }

  TEST(Mover, RigidBodyIsFilledAndDriven)
  {
    ParticleScene<2> s(box_of_gel("1, 1", support("  set Where = body disk\n  set Displacement = 0; -0.1*t\n"), disk));
    ASSERT_EQ(s.movers.size(), 1u);
    EXPECT_EQ(s.movers[0].rigid->body, 1u);
    const Particles::RigidStep<2> step(*s.movers[0].rigid, s.movers[0].rigid->pose(0.), {}, .5, .7);
    EXPECT_NEAR(step.velocity({.5, 1.4})[1], -.1, 1e-9);
    EXPECT_NEAR(s.movers[0].distance(s.scene, {.5, 1.}), 0., 1e-15);
    const auto particles = s.arrange(.05, .1);
    EXPECT_EQ(particles.n_free, 400u);
    double area = 0.;
    for (unsigned int i = particles.n_free; i < particles.n_owned; ++i)
      {
        const double r = particles.X[i].distance({.5, 1.4});
        EXPECT_TRUE(r <= .4 && r >= .3);
        area += particles.V0[i];
      }
    EXPECT_NEAR(area, dealii::numbers::PI * (.16 - .09), .03);
  }

  TEST(Mover, RigidBodyWithoutSupportRests)
  {
    ParticleScene<2> s(box_of_gel("1, 1", "", disk));
    EXPECT_EQ(s.movers.at(0).support, -1);
    EXPECT_FALSE(s.movers[0].moves);
    const Particles::RigidStep<2> step(*s.movers[0].rigid, s.movers[0].rigid->pose(0.), {}, 0., 1.);
    EXPECT_EQ(step.velocity({.5, 1.4}).norm(), 0.);
    EXPECT_EQ(step.to.displacement({.5, 1.4}).norm(), 0.);
  }

  TEST(Mover, PlacesOfATurningBodyGoAlongTheirChords)
  {
    for (const std::string motion : {"set Rotation = 3*t\n  set Displacement = 0; -0.1*t",
                                     "set Type = velocity\n  set Angular velocity = 3\n  set Velocity = 0; -0.1"})
      {
        ParticleScene<2> s(box_of_gel("1, 1", support("  set Where = body disk\n  " + motion + "\n"), disk));
        EXPECT_TRUE(s.movers.at(0).varies_in_space);
        const dealii::Point<2> X(.8, 1.5);
        dealii::Point<2>       x    = X;
        auto                   pose = s.movers[0].rigid->pose(0.);
        for (unsigned int n = 0; n < 4; ++n)
          {
            const Particles::RigidStep<2> step(*s.movers[0].rigid, pose, {}, .25 * n, .25 * (n + 1));
            x += .25 * step.velocity(X);
            pose = step.to;
            EXPECT_LT(x.distance(pose.place(X)), 1e-14);
          }
        // About the disk's centre, (.5, 1.4).
        const double angle = 3., c = std::cos(angle), s_ = std::sin(angle);
        EXPECT_LT(x.distance({.5 + c * .3 - s_ * .1, 1.3 + s_ * .3 + c * .1}), 1e-13) << motion;
      }
  }

  TEST(Mover, MaterialRegionsAreNoMovers)
  {
    for (const std::string region :
         {"layer y-min 0.1", "box 0, 0 : 1, 0.1", "ball 0, 0 : 0.2", "material gel", "nearest 0, 0", "all"})
      EXPECT_TRUE(ParticleScene<2>(box_of_gel("1, 1", support("  set Where = " + region + "\n  set Type = clamp\n")))
                    .movers.empty());
  }

  TEST(Mover, WhatParticlesCannotHold)
  {
    EXPECT_EQ(message(box_of_gel("1, 1", support("  set Where = side y-min\n  set Type = symmetry\n"))),
              "test.prm:21: support 'top' on 'side y-min' leaves component x free, but particles hold sides "
              "only in all; use 'Type = clamp' or give all 2 components");
    EXPECT_TRUE(contains(message(box_of_gel("1, 1", support("  set Where = rim 0, 0 : 1\n  set Type = clamp\n"))),
                         "holds a rim"));
    EXPECT_TRUE(contains(message(box_of_gel("1, 1", support("  set Where = side y-max\n  set Type = clamp\n") +
                                                      "subsection Periodic\n set Directions = y\nend\n")),
                         "where the scene repeats"));
    EXPECT_TRUE(contains(
      message(box_of_gel("1, 1", support("  set Where = side y-max\n  set Type = clamp\n end\n subsection more\n"
                                         "  set Where = side y-max\n  set Type = clamp\n"))),
      "hold the same side"));
  }
} // namespace
