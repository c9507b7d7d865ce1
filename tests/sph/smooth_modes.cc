// Smooth modes of the closing: what splines reproduce.

#include "../base/keep_largest.h"
#include "../particles/scene_fixture.h"

#include <stroma/sph/smooth_modes.h>
#include <stroma/sph/system.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  // With the identity for the equations the modes are a projection, which leaves fields of second order as they are.
  TEST(SmoothModes, MpiFieldsOfSecondOrderAreTheirs)
  {
    const double     dp = .05;
    ParticleScene<2> fixture(
      scene_of(hypoelastic("gel", 1., .3, "  set Density = 1\n  set Viscosity = 1\n"), box_body("block", "1, 0.7")));
    Sph::Settings settings;
    Timers        timers;
    settings.arrangement.spacing = dp;
    settings.arrangement.jitter  = .3;
    Sph::System<2> system(fixture.scene, settings, Sph::Dynamics::overdamped, 1., timers);
    system.arrange();
    ASSERT_EQ(system.update_geometry(true), StepStatus::ok);
    const auto &particles = system.particles;
    using Modes           = Sph::SmoothModes<2>;
    Modes modes(*system.neighbours, particles, dp, 2.6 * dp, std::vector<std::uint8_t>(particles.size(), 0));

    Modes::Block                identity;
    std::vector<Modes::Unknown> x(particles.n_free), y(particles.n_free);
    for (unsigned int e = 0; e < 3; ++e)
      identity[e][e] = 1.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        const double X = particles.x[i][0], Y = particles.x[i][1];
        x[i][0][0] = (1. + 2. * X - Y + 3. * X * X - X * Y) / dp; // f over the spacing, and grad f/2
        x[i][0][1] = .5 * (2. + 6. * X - Y);
        x[i][0][2] = .5 * (-1. - X);
        x[i][1][0] = Y * Y / dp;
        x[i][1][2] = Y;
        modes.add(i, identity);
      }
    modes.factorise();
    modes.add_solution(y.data(), x.data());
    double worst = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (unsigned int k = 0; k < 2; ++k)
        keep_largest(worst, (y[i][k] - x[i][k]).norm());
    EXPECT_LT(worst, 1e-5); // of numbers up to 100
  }
} // namespace
