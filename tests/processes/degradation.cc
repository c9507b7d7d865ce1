// Where and how fast a rigid body degrades what is around it, and what a scene may not ask for.

#include "../base/keep_largest.h"
#include "../scene/scene_of.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace Stroma;

namespace
{
  /// A ball of radius 1 in the middle of a block, that goes along y.
  template <int dim>
  SceneOf<dim>
  cell(const double diffusion = 0.)
  {
    const auto at   = [&](const std::string &x) { return x + ", " + x + (dim == 2 ? "" : ", " + x); };
    const auto more = std::string(dim == 2 ? "set Thickness = 1\n" : "") +
                      section("Migration", "run",
                              "  set Body = cell\n  set Force = 3\n  set Direction = " +
                                std::string(dim == 2 ? "0, 2" : "0, 2, 0") +
                                "\n  set Rotational diffusion = " + std::to_string(diffusion) + "\n") +
                      section("Degradation", "front",
                              "  set Rate = 2\n  set Decay length = 0.25\n  set Width = 1\n  set Angle = 60\n"
                              "  set Initial width = 0.5\n");
    return SceneOf<dim>(box("block", at("0"), at("10"), "  set Material = gel\n") +
                          " subsection cell\n  set Shape = ball\n  set Centre = " + at("5") +
                          "\n  set Radius = 1\n  set Rigid = true\n end\n",
                        more);
  }

  /// f after 1/100 s of what was intact, at the distance @p d from the surface and the angle @p a [degrees] from the direction, with
  /// the body moved by 1 along x and turned.
  template <int dim>
  double
  after(const SceneOf<dim> &fixture, const double d, const double a)
  {
    const auto      &front = fixture.scene.degradations[0];
    Rigid::Pose<dim> pose;
    for (unsigned int c = 0; c < dim; ++c)
      pose.pivot[c] = 5.;
    pose.translation[0] = 1.;
    pose.rotation[0]    = .3;
    auto         x      = pose.pivot + pose.translation;
    const double angle  = a * std::acos(-1.) / 180.;
    x[0] += (1. + d) * std::sin(angle);
    x[1] += (1. + d) * std::cos(angle);
    return front.after(1., *fixture.scene.bodies[front.body].shape, pose, x, 3., .01);
  }
} // namespace

TEST(Degradation, FrontIsWithinAngleAndWidth)
{
  const auto plane = cell<2>();
  const auto space = cell<3>();
  for (const double a : {0., 59.9, -59.9})
    for (const double d : {0., .3, .99})
      {
        EXPECT_DOUBLE_EQ(after(plane, d, a), 1. - .02 * std::exp(-d / .25)) << d << " " << a;
        EXPECT_NEAR(after(space, d, a), 1. - .02 * std::exp(-d / .25), 1e-14);
      }
  for (const auto &[d, a] : {std::pair(1.01, 0.), {.3, 60.1}, {.3, -60.1}, {.3, 180.}})
    {
      EXPECT_EQ(after(plane, d, a), 1.) << d << " " << a;
      EXPECT_EQ(after(space, d, a), 1.);
    }
}

TEST(Degradation, FactorsEndAtZero)
{
  const auto     plane = cell<2>();
  const auto    &front = plane.scene.degradations[0];
  Rigid::Pose<2> pose;
  pose.pivot        = dealii::Point<2>(5., 5.);
  const auto &shape = *plane.scene.bodies[front.body].shape;
  const auto  f     = [&](const double before, const double dt) {
    return front.after(before, shape, pose, dealii::Point<2>(5., 6.), 0., dt);
  };
  EXPECT_NEAR(f(1., .2), .6, 1e-14);
  EXPECT_NEAR(f(.6, .2), f(1., .4), 1e-14) << "a step is two of half its length";
  EXPECT_EQ(f(1., 7.), 0.);
  EXPECT_EQ(f(0., 7.), 0.);
}

TEST(Degradation, StartIsAFluidAllAround)
{
  const auto  plane = cell<2>();
  const auto &front = plane.scene.degradations[0];
  const auto &shape = *plane.scene.bodies[front.body].shape;
  for (const auto &[y, f] : {std::pair(6.49, 0.), {6.51, 1.}, {3.51, 0.}, {3.49, 1.}})
    EXPECT_EQ(front.at_start(shape, dealii::Point<2>(5., y)), f) << y;
}

TEST(Migration, ForceHasItsSizeAndDirection)
{
  const auto plane = cell<2>();
  EXPECT_NEAR((plane.scene.migrations[0].force(17.) - dealii::Tensor<1, 2>({0., 3.})).norm(), 0., 1e-12);
  EXPECT_NEAR((plane.scene.rigid_bodies[0].drive.force(17.) - dealii::Tensor<1, 2>({0., 3.})).norm(), 0., 1e-12);
  const auto space  = cell<3>(.01);
  double     across = 0.;
  for (unsigned int i = 0; i < 100; ++i)
    {
      const auto u = space.scene.migrations[0].direction(7. * i);
      EXPECT_NEAR(u.norm(), 1., 1e-12);
      keep_largest(across, std::hypot(u[0], u[2]));
    }
  EXPECT_GT(across, .2);
}
