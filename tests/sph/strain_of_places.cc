// Stresses of viscous solids come to those of the strain of places: exact in large shear, and nothing stays where places are undeformed.

#include "../base/keep_largest.h"
#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  const double young = 1., poisson = .3, mu = young / (2. * (1. + poisson));

  /// A strip, endless along x, between a floor and a side that moves by @p motion.
  std::string
  strip(const std::string &motion, const std::string &more = "  set Viscosity = 1\n")
  {
    return scene_of(hypoelastic("gel", young, poisson, "  set Density = 1\n" + more), box_body("strip", "0.5, 0.5")) +
           "subsection Periodic\n set Directions = x\nend\n"
           "subsection Supports\n subsection floor\n  set Where = side y-min\n  set Type = clamp\n end\n"
           " subsection top\n  set Where = side y-max\n  set Displacement = " +
           motion +
           "\n end\nend\n"
           "subsection NSPH\n set Spacing = 0.05\nend\nsubsection SPH\n set Spacing = 0.05\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-10\nend\n";
  }

  template <typename Method>
  void
  go(Open<Method> &method, const double from, const double to, const unsigned int n)
  {
    StepWork work;
    for (unsigned int step = 0; step < n; ++step)
      ASSERT_EQ(method.advance(from + step * (to - from) / n, from + (step + 1) * (to - from) / n, work),
                StepStatus::ok);
  }

  /// Largest stress of a strip at rest after its rows were given stresses and volumes that alternate.
  template <typename Method, typename Time>
  double
  left_over(const std::string &text, const Time &time)
  {
    ParticleScene<2> scene(text);
    Timers           timers;
    Open<Method>     method(scene.parameters, scene.scene, time, timers);
    method.setup(nullptr);
    auto &particles = method.system->particles;
    for (unsigned int i = 0; i < particles.size(); ++i)
      {
        const double sign = static_cast<int>(particles.X[i][1] / .05) % 2 == 0 ? 1. : -1.;
        particles.S[i]    = .01 * sign * dealii::unit_symmetric_tensor<2>();
        particles.J[i]    = 1. + .01 * sign;
      }
    go(method, 0., 40., 40);
    double     largest = 0.;
    const auto all     = method.system->stresses();
    for (unsigned int i = 0; i < particles.n_free; ++i)
      keep_largest(largest, all[i].norm());
    return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
  }

  TEST(StrainOfPlaces, MpiNothingStaysWherePlacesAreUndeformed)
  {
    EXPECT_LT(left_over<Sph::NsphMethod<2>>(strip("0; 0"), steps_to(40.)), 1e-6);
    EXPECT_LT(left_over<Sph::SphMethod<2>>(strip("0; 0", "  set Viscosity = 0.02\n"), 40.), 1e-6);
  }

  TEST(StrainOfPlaces, WithoutFrictionRatesAreLeftAlone)
  {
    EXPECT_GT(left_over<Sph::SphMethod<2>>(strip("0; 0", ""), 40.), 1e-3);
  }

  // V = sqrt(F F^T) of a simple shear by gamma has the stretches exp(+-asinh(gamma/2)), along axes with tan(2 angle) = 2/gamma. Rows
  // beside the sides are off by up to 1.4 %.
  TEST(StrainOfPlaces, LargeShearHasTheStressOfLogarithmicStrain)
  {
    const double             gamma = .8;
    ParticleScene<2>         scene(strip("0.4*min(t, 1); 0"));
    Timers                   timers;
    Open<Sph::NsphMethod<2>> method(scene.parameters, scene.scene, steps_to(301.), timers);
    method.setup(nullptr);
    go(method, 0., 1., 80);
    go(method, 1., 301., 60);
    const double log_stretch = std::asinh(gamma / 2.), along = gamma / 2. / std::hypot(1., gamma / 2.);
    const auto  &particles = method.system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        EXPECT_NEAR(particles.J[i], 1., 5e-3);
        EXPECT_NEAR(particles.S[i][0][0], 2. * mu * log_stretch * along, 2e-2 * mu);
        EXPECT_NEAR(particles.S[i][0][1], 2. * mu * log_stretch * std::sqrt(1. - along * along), 2e-2 * mu);
      }
  }
} // namespace
