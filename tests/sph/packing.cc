// Places and volumes of a fluid's particles that fit each other.

#include "../base/keep_largest.h"
#include "../particles/scene_fixture.h"

#include <stroma/sph/system.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  const std::string one_fluid =
    "subsection Materials\n subsection water\n  set Law = fluid\n  set Viscosity = 1\n"
    "  set Viscous operator = morris\n  set Bulk modulus = 1000\n  set Density = 1\n end\nend\n";
  const std::string square_body =
    "subsection Bodies\n subsection water\n  set Shape = box\n  set Upper corner = 1, 1\n end\nend\n";
  const std::string cube_body =
    "subsection Bodies\n subsection water\n  set Shape = box\n  set Upper corner = 1, 1, 1\n end\nend\n";

  template <int dim>
  struct BoxOfWater
  {
    BoxOfWater(const std::string &text, const double spacing, const double jitter)
      : fixture(one_fluid + text)
    {
      Sph::Settings settings;
      settings.arrangement.spacing = spacing;
      settings.arrangement.jitter  = jitter;
      system = std::make_unique<Sph::System<dim>>(fixture.scene, settings, Sph::Dynamics::inertial, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
      system->set_step(0., 1.);
    }

    ParticleScene<dim>                fixture;
    Timers                            timers;
    std::unique_ptr<Sph::System<dim>> system;
  };
} // namespace

TEST(Packing, MpiLatticesAreNotCrowded)
{
  const BoxOfWater<2> closed(square_body + clamped({"x-min", "x-max", "y-min", "y-max"}), .1, 0.);
  EXPECT_LT(closed.system->packing->mean_excess(closed.system->particles), 1e-12);
  const BoxOfWater<3> open(cube_body + clamped({"z-min"}), .2, 0.);
  EXPECT_LT(open.system->packing->mean_excess(open.system->particles), 1e-12);
}

TEST(Packing, MpiVolumesThatOutgrowTheirPlacesEndTheRun)
{
  BoxOfWater<2> water(square_body + clamped({"x-min", "x-max", "y-min", "y-max"}), .1, 0.);
  auto         &system = *water.system;
  system.set_gradient(system.with_walls(system.particles.v));
  EXPECT_EQ(system.check(system.particles.v, .1, .2, 1.), StepStatus::ok);
  for (auto &J : system.particles.J)
    J *= 1.2;
  EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
  system.set_gradient(system.with_walls(system.particles.v));
  EXPECT_EQ(system.check(system.particles.v, .1, .2, 1.), StepStatus::drifted_apart);
}

TEST(Packing, MpiShiftsAreNoneOnALatticeAndTakeCrowdedParticlesApart)
{
  BoxOfWater<2>                           water(square_body + clamped({"x-min", "x-max", "y-min", "y-max"}), .1, 0.);
  auto                                   &system    = *water.system;
  auto                                   &particles = system.particles;
  const std::vector<dealii::Tensor<1, 2>> v(system.pairs.n_points(), dealii::Tensor<1, 2>{{1., 0.}});
  for (const auto &dx : system.packing->shifts(particles, v, 1.))
    EXPECT_LT(dx.norm(), 1e-12);

  // Particles left and right of the middle, .6 spacings from each other instead of one.
  const auto is_moved = [&](const unsigned int i) { return std::abs(particles.X[i][0] - .5) < .06; };
  for (unsigned int i = 0; i < particles.n_free; ++i)
    if (is_moved(i))
      particles.x[i][0] += particles.X[i][0] < .5 ? .02 : -.02;
  const auto gap = [&] { // the same all along
    double left = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      if (is_moved(i))
        keep_largest(left, .5 - std::abs(particles.x[i][0] - .5));
    return 1. - 2. * dealii::Utilities::MPI::max(left, MPI_COMM_WORLD);
  };
  EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
  EXPECT_NEAR(gap(), .06, 1e-12);
  system.set_gradient(system.with_walls(Sph::System<2>::Velocities(particles.size())));
  system.shift(Sph::System<2>::Velocities(system.pairs.n_points(), dealii::Tensor<1, 2>{{1., 0.}}), 1e-3);
  EXPECT_GT(gap(), .06 + 1e-4);
  EXPECT_LE(gap(), .06 + 2e-3 + 1e-12) << "farther than the particles have moved";
}

TEST(Packing, MpiShiftedParticlesTakeOnTheStateOfWhereTheyComeTo)
{
  BoxOfWater<2> water(square_body + clamped({"x-min", "x-max", "y-min", "y-max"}), .1, .2);
  auto         &system    = *water.system;
  auto         &particles = system.particles;
  const auto    J         = [](const dealii::Point<2> &x) { return 1.01 + .01 * x[0] - .02 * x[1]; };
  for (unsigned int i = 0; i < particles.n_owned; ++i)
    particles.J[i] = J(particles.x[i]);
  EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
  system.set_gradient(system.with_walls(Sph::System<2>::Velocities(particles.size())));
  const auto x = particles.x;
  system.shift(Sph::System<2>::Velocities(system.pairs.n_points(), dealii::Tensor<1, 2>{{1., 0.}}), .01);
  double move = 0.;
  for (unsigned int i = 0; i < particles.n_free; ++i)
    {
      EXPECT_NEAR(particles.J[i], J(particles.x[i]), 1e-12);
      keep_largest(move, particles.x[i].distance(x[i]));
    }
  EXPECT_GT(dealii::Utilities::MPI::max(move, MPI_COMM_WORLD), 1e-4);
}
