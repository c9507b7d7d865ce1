// Contact of particles with rigid bodies: no force before surfaces meet, the exact stress afterwards, no drift over many cycles.

#include "../particles/scene_fixture.h"

#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  template <typename Method>
  struct Open : public Method
  {
    using Method::Method;
    using Method::system;
  };

  const double E = 1., nu = .3, height = .5, gap = .02; // the lattice ends .025 below the surface

  /// A strip of material, endless along x, below a rigid block that moves by @p motion and is @p gap above it at the start.
  std::string
  press(const std::string &motion, const std::string &type = "stick")
  {
    return "subsection Materials\n subsection gel\n  set Law = hypoelastic\n  set Young's modulus = 1\n  set Poisson's ratio = 0.3\n"
           "  set Density = 1\n  set Viscosity = 1\n end\nend\n"
           "subsection Bodies\n subsection strip\n  set Shape = box\n  set Upper corner = 0.3, 0.5\n end\n"
           " subsection block\n  set Shape = box\n  set Lower corner = -0.3, 0.52\n  set Upper corner = 0.6, 0.72\n  set Rigid = true\n end\n"
           "end\nsubsection Periodic\n set Directions = x\nend\n"
           "subsection Supports\n subsection floor\n  set Where = side y-min\n  set Type = clamp\n end\n"
           " subsection drive\n  set Where = body block\n  set Displacement = " +
           motion +
           "\n end\nend\n"
           "subsection Contact\n subsection touch\n  set Body = block\n  set Type = " +
           type +
           "\n end\nend\n"
           "subsection NSPH\n set Spacing = 0.05\nend\nsubsection SPH\n set Spacing = 0.05\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-10\nend\n";
  }

  /// Of a strip whose height has become @p stretch times what it was [Pa].
  double
  pressure(const double stretch)
  {
    const double K = E / (3. * (1. - 2. * nu)), G = E / (2. * (1. + nu));
    return K * (1. / stretch - 1.) - 4. / 3. * G * std::log(stretch);
  }

  Solvers::StepSettings
  steps_to(const double end)
  {
    Solvers::StepSettings steps;
    steps.end_time = end;
    return steps;
  }

  template <typename Method>
  class Press
  {
  public:
    template <typename Time>
    Press(const std::string &text, const std::vector<std::string> &set, const Time &time)
      : scene(text, set)
      , method(scene.parameters, scene.scene, time, timers)
    {
      method.setup(nullptr);
    }

    void
    go_to(const double next)
    {
      StepWork work;
      EXPECT_EQ(method.advance(t, next, work), StepStatus::ok) << "to t = " << next;
      t = next;
    }

    double
    operator[](const std::string &name) const
    {
      for (const auto &scalar : method.scalars)
        if (scalar.first == name)
          return scalar.second;
      ADD_FAILURE() << "no " << name;
      return 0.;
    }

    /// Largest size of a principal part of the stress [Pa].
    double
    largest_stress() const
    {
      double     largest = 0.;
      const auto all     = method.system->stresses();
      for (unsigned int i = 0; i < method.system->particles.n_free; ++i)
        largest = std::max(largest, all[i].norm());
      return dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD);
    }

    ParticleScene<2> scene;
    Timers           timers;
    Open<Method>     method;
    double           t = 0.;
  };

  TEST(Contact, MpiSurfacesMeetWithoutAForceAndThenPress)
  {
    for (const std::string type : {"stick", "frictionless"})
      for (const std::string arrangement : {"square", "hexagonal"})
        for (const double step : {.0625, .125}) // until the motion ends
          {
            Press<Sph::NsphMethod<2>> press_it(press("0; -0.04*min(t, 1)", type), {"NSPH/Arrangement=" + arrangement},
                                               steps_to(1000.));
            for (double t = step; t <= 1.; t += step)
              {
                press_it.go_to(t);
                if (t < .49)
                  {
                    EXPECT_EQ(press_it["contact_particles_block"], 0.);
                    EXPECT_EQ(press_it.largest_stress(), 0.);
                  }
              }
            for (const double t : {50., 1000.})
              press_it.go_to(t);
            const double expected = pressure((height - .02) / height);
            EXPECT_EQ(press_it["contact_particles_block"], 6.) << type << ", " << arrangement;
            EXPECT_NEAR(press_it["contact_area_block_m2"], .3, .3 * .015) << type << ", " << arrangement;
            EXPECT_NEAR(press_it["contact_pressure_max_block_Pa"], expected, .02 * expected)
              << type << ", " << arrangement << ", " << step;
            EXPECT_NEAR(press_it["contact_force_block_y_N"], .3 * expected, .3 * .02 * expected)
              << type << ", " << arrangement << ", " << step;
          }
  }

  TEST(Contact, WhatIsPulledComesOffUnlessItSticksForGood)
  {
    for (const std::string cut_off : {"true", "false"})
      {
        Press<Sph::NsphMethod<2>> press_it(press("0; -0.04*sin(pi*t/2)"), {"NSPH/Contact/Tension cut-off=" + cut_off},
                                           steps_to(3.));
        for (double t = .1; t <= 3.; t += .1)
          press_it.go_to(t);
        EXPECT_EQ(press_it["contact_particles_block"], cut_off == "true" ? 0. : 6.);
        EXPECT_EQ(press_it["block_force_y_N"] > .01, cut_off == "false");
      }
  }

  // The block comes down and goes up faster than the material follows, whose relaxation takes 3 s. What drifts is the state of particles
  // that move, of second order in the step: four times more with twice the step, and more where the block never lets go.
  TEST(Contact, CyclesOfMakingAndBreakingLetNothingDrift)
  {
    Press<Sph::NsphMethod<2>> press_it(press("0; -0.03*sin(pi*t/10)^2*max(0, min(1, (200 - t)/10))"), {},
                                       steps_to(400.));
    double                    first = 0., last = 0.;
    for (unsigned int step = 1; step <= 400; ++step)
      {
        press_it.go_to(.5 * step);
        if (step % 10 == 0 && step <= 380) // the last one stays above
          {
            EXPECT_EQ(press_it["contact_particles_block"] > 0., step % 20 == 10) << step;
          }
        if (step <= 20)
          first = std::max(first, press_it["strain_energy_J"]);
        else if (step > 360 && step <= 380)
          last = std::max(last, press_it["strain_energy_J"]);
      }
    press_it.go_to(250.);
    press_it.go_to(400.);
    EXPECT_NEAR(last, first, .06 * first);
    EXPECT_LT(press_it["strain_energy_J"], .02 * first);
  }

  /// A block with free sides below a plate that overhangs it, is pressed down until t = 1 and goes sideways from t = 20 on.
  std::string
  rub(const double friction)
  {
    auto text = press("0.001*max(0, t - 20); -0.04*min(t, 1)",
                      "Coulomb\n  set Friction coefficient = " + std::to_string(friction));
    for (const auto &[from, to] :
         std::vector<std::pair<std::string, std::string>>{{"subsection Periodic\n set Directions = x\nend\n", ""},
                                                          {"Upper corner = 0.6, 0.72", "Upper corner = 0.9, 0.72"},
                                                          {"Upper corner = 0.3, 0.5", "Upper corner = 0.6, 0.5"}})
      text.replace(text.find(from), from.size(), to);
    return text;
  }

  TEST(Contact, FrictionSticksUpToItsCoefficientAndSlidesWithIt)
  {
    for (const double friction : {.1, .3})
      {
        Press<Sph::NsphMethod<2>> press_it(rub(friction), {}, steps_to(60.));
        const auto                ratio = [&] { return press_it["block_force_x_N"] / -press_it["block_force_y_N"]; };
        for (double t = .2; t < 19.9; t += t < .9 ? .2 : 1.)
          press_it.go_to(t);
        press_it.go_to(20.);
        EXPECT_LT(std::abs(ratio()), 1e-3);
        press_it.go_to(20.5); // .0005 m to the side
        EXPECT_GT(ratio(), 0.);
        EXPECT_LT(ratio(), .7 * friction);
        for (double t = 21.; t <= 60.; t += 1.)
          press_it.go_to(t);
        EXPECT_NEAR(ratio(), friction, .03 * friction);
      }
  }

  TEST(Contact, InertialParticlesMeetTheSamePressure)
  {
    Press<Sph::SphMethod<2>> press_it(press("0; -0.04*sin(pi*min(t, 1)/2)"), {}, 12.);
    for (const double t : {.1, .3, .6, 1., 4., 12.})
      press_it.go_to(t);
    const double expected = pressure((height - .02) / height);
    EXPECT_EQ(press_it["contact_particles_block"], 6.);
    EXPECT_NEAR(press_it["contact_force_block_y_N"], .3 * expected, .3 * .02 * expected);
    EXPECT_NEAR(press_it["contact_pressure_max_block_Pa"], expected, .02 * expected);
  }
} // namespace
