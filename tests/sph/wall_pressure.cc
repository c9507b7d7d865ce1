// Pressures of fluids at walls and at free surfaces: what balances a weight, and the dilatation that goes with it.

#include "../base/keep_largest.h"
#include "../particles/scene_fixture.h"

#include <stroma/sph/system.h>

#include <gtest/gtest.h>

#include <random>

using namespace Stroma;
using dealii::Tensor;

namespace
{
  const std::string two_fluids =
    "subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 1\n"
    "  set Viscous operator = morris\n  set Bulk modulus = 1000\n  set Density = 1\n end\nend\n";
  const std::string box_of_water =
    "subsection Bodies\n subsection water\n  set Shape = box\n  set Upper corner = 1, 0.5\n end\nend\n";
  const std::string disc_of_water =
    "subsection Bodies\n subsection water\n  set Shape = ball\n  set Centre = .3, -.7\n  set Radius = 2.8\n end\nend\n";
  const std::string box_3d =
    "subsection Bodies\n subsection water\n  set Shape = box\n  set Upper corner = 1, .6, .6\n end\nend\n";

  template <int dim>
  struct Water
  {
    Water(const std::string &text, const double spacing, const double jitter, const std::string &arrangement = "square")
      : fixture(two_fluids + text)
    {
      Sph::Settings settings;
      settings.arrangement.spacing = spacing;
      settings.arrangement.jitter  = jitter;
      if (arrangement == "hexagonal")
        settings.arrangement.name = Sph::ArrangementName::hexagonal;
      system = std::make_unique<Sph::System<dim>>(fixture.scene, settings, Sph::Dynamics::inertial, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
      system->set_step(0., 1.);
    }

    /// Forces of pressures @p p on free particles.
    template <typename Pressure>
    std::vector<Tensor<1, dim>>
    force(const Pressure &p) const
    {
      std::vector<dealii::SymmetricTensor<2, dim>> stresses(system->particles.size());
      for (unsigned int i = 0; i < stresses.size(); ++i)
        if (!system->particles.is_fixed(i))
          stresses[i] = -p(i) * dealii::unit_symmetric_tensor<dim>();
      std::vector<Tensor<1, dim>> f(system->particles.n_free);
      system->elasticity->add_stress_force(f, stresses);
      return f;
    }

    /// Largest force that a pressure linear in depth below @p level leaves of a unit weight, over the weight.
    double
    left_of_weight(const double level) const
    {
      const auto &particles = system->particles;
      double      largest   = 0.;
      const auto  f         = force([&](const unsigned int i) { return level - particles.x[i][dim - 1]; });
      for (unsigned int i = 0; i < f.size(); ++i)
        {
          const double   V   = particles.volume(i);
          Tensor<1, dim> sum = f[i] / V;
          sum[dim - 1] -= 1.;
          keep_largest(largest, sum.norm());
        }
      return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
    }

    ParticleScene<dim>                fixture;
    Timers                            timers;
    std::unique_ptr<Sph::System<dim>> system;
  };
} // namespace

TEST(WallPressure, MpiLinearPressuresBalanceAWeightInAFullVessel)
{
  // .6 of the weight was left in the corners.
  const auto all = clamped({"x-min", "x-max", "y-min", "y-max"});
  EXPECT_LT(Water<2>(box_of_water + all, .1, 0.).left_of_weight(.5), .02);
  EXPECT_LT(Water<2>(box_of_water + all, .05, 0., "hexagonal").left_of_weight(.5), .05); // of rows cut by the sides
  EXPECT_LT(
    Water<3>(box_3d + clamped({"x-min", "x-max", "y-min", "y-max", "z-min", "z-max"}), .2, 0.).left_of_weight(.6), .02);
}

TEST(WallPressure, MpiLinearPressuresBalanceAWeightBelowAFreeSurface)
{
  // .9 of the weight was left.
  EXPECT_LT(Water<2>(box_of_water + clamped({"x-min", "x-max", "y-min"}), .1, 0.).left_of_weight(.5), .01);
  EXPECT_LT(Water<3>(box_3d + clamped({"x-min", "x-max", "y-min", "y-max", "z-min"}), .2, 0.).left_of_weight(.6), .01);
}

TEST(WallPressure, MpiForcesAtASurfaceAreAsSymmetricAsItsParticles)
{
  // Corners of the lattice along a diagonal leave out two directions alike: rounding chose the normal there.
  // (Motions linear in place tell nothing: closed area vectors do no work in them.)
  const Water<2>      water(disc_of_water, .1, 0.);
  const auto         &particles = water.system->particles;
  const auto          f         = water.force([](const unsigned int) { return 1.; });
  std::vector<double> sums(3); // the last is what the others are judged against
  for (unsigned int i = 0; i < f.size(); ++i)
    {
      const auto x = particles.x[i] - dealii::Point<2>(.3, -.7);
      sums[0] += f[i][0] * std::pow(x[0], 3) - f[i][1] * std::pow(x[1], 3);
      sums[1] += f[i][0] * std::pow(x[1], 3) + f[i][1] * std::pow(x[0], 3);
      sums[2] += f[i].norm() * std::pow(x.norm(), 3);
    }
  dealii::Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
  EXPECT_GT(sums[2], 1.);
  EXPECT_LT(std::abs(sums[0]), 1e-8 * sums[2]);
  EXPECT_LT(std::abs(sums[1]), 1e-8 * sums[2]);
}

TEST(WallPressure, MpiWorkOfPressuresIsThatOfTheDilatation)
{
  const Water<2> water(box_of_water + clamped({"x-min", "x-max", "y-min"}), .1, .2);
  auto          &system    = *water.system;
  const auto    &particles = system.particles;
  const auto     some      = [&](const unsigned int i, const unsigned int k) {
    return std::sin(1. + 7.3 * particles.id[i] + 2.9 * k);
  };
  Sph::System<2>::Velocities v(particles.size());
  for (unsigned int i = 0; i < particles.size(); ++i)
    if (!particles.is_fixed(i))
      v[i] = Tensor<1, 2>{{some(i, 0), some(i, 1)}};
  const auto f = water.force([&](const unsigned int i) { return some(i, 2); });

  std::vector<Tensor<2, 2>> L(system.pairs.n_rows());
  system.elasticity->velocity_gradient(L, system.with_walls(v));
  system.elasticity->add_wall_dilatation(L, system.with_walls(v));
  std::vector<double> sums(2);
  for (unsigned int i = 0; i < particles.n_free; ++i)
    {
      sums[0] += f[i] * v[i];
      sums[1] += some(i, 2) * trace(L[i]) * system.pairs.volume_share[i] * particles.volume(i);
    }
  dealii::Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
  EXPECT_NEAR(sums[0], sums[1], 1e-12 * std::abs(sums[1]) + 1e-14);
  EXPECT_GT(std::abs(sums[1]), 1e-3);
}

TEST(WallPressure, MpiStiffnessIsTheTangentOfTheForces)
{
  // of pressure alone: K theta into the force of the theta that a motion makes
  const Water<2>             water(box_of_water + clamped({"x-min", "x-max", "y-min"}), .1, .1);
  auto                      &system    = *water.system;
  const auto                &particles = system.particles;
  Sph::System<2>::Velocities u(particles.size());
  for (unsigned int i = 0; i < particles.size(); ++i)
    if (!particles.is_fixed(i))
      u[i] = Tensor<1, 2>{{std::sin(3. * particles.id[i]), std::cos(5. * particles.id[i])}};
  const auto                all = system.with_walls(u);
  std::vector<Tensor<2, 2>> L(system.pairs.n_rows());
  system.elasticity->velocity_gradient(L, all);
  system.elasticity->add_wall_dilatation(L, all);
  std::vector<double> theta(particles.size());
  for (unsigned int i = 0; i < system.pairs.n_rows(); ++i)
    theta[i] = trace(L[i]);
  system.neighbours->update_ghosts(theta);
  const auto                 f = water.force([&](const unsigned int i) { return -1000. * theta[i]; });
  Sph::System<2>::Velocities stiff(particles.n_free);
  system.elasticity->combine(1., 0.);
  system.elasticity->add_stiffness_force(stiff, all);
  for (unsigned int i = 0; i < particles.n_free; ++i)
    EXPECT_LT((stiff[i] - f[i]).norm(), 1e-9 * (1. + f[i].norm())) << particles.X[i];
}
