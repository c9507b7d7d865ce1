// Contact of particles with rigid bodies: no force before surfaces meet, the exact stress afterwards, no drift over many cycles.

#include "../base/keep_largest.h"
#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  const double E = 1., nu = .3, height = .5, gap = .02; // the lattice ends .025 below the surface

  /// A strip of material, endless along x, below a rigid block that moves by @p motion and is @p gap above it at the start.
  std::string
  press(const std::string &motion, const std::string &type = "stick")
  {
    return scene_of(hypoelastic("gel", E, nu, "  set Density = 1\n  set Viscosity = 1\n"),
                    box_body("strip", "0.3, 0.5") +
                      box_body("block", "0.6, 0.72", "  set Lower corner = -0.3, 0.52\n  set Rigid = true\n")) +
           "subsection Periodic\n set Directions = x\nend\n"
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
  pressure(const double stretch, const double poisson = nu)
  {
    const double K = E / (3. * (1. - 2. * poisson)), G = E / (2. * (1. + poisson));
    return K * (1. / stretch - 1.) - 4. / 3. * G * std::log(stretch);
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
        keep_largest(largest, all[i].norm());
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

  TEST(Contact, HalfOfTheHeightIsPressedAway)
  {
    for (const double poisson : {.3, .49})
      {
        Press<Sph::NsphMethod<2>> press_it(press("0; -0.27*min(t, 1)"),
                                           {"Materials/gel/Poisson's ratio=" + shortest(poisson)}, steps_to(1000.));
        for (unsigned int i = 1; i <= 80; ++i)
          press_it.go_to(i / 80.);
        for (const double t : {50., 1000.})
          press_it.go_to(t);
        const double expected = pressure(.5, poisson);
        EXPECT_NEAR(press_it["contact_pressure_max_block_Pa"], expected, .01 * expected) << poisson;
        EXPECT_NEAR(press_it["contact_force_block_y_N"], .3 * expected, .3 * .002 * expected) << poisson;
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

  // The block comes down and goes up faster than the material follows, whose relaxation takes 3 s. By rates alone the peak drifts by 5 % over
  // these cycles, with twice the step by 12 %.
  TEST(Contact, CyclesOfMakingAndBreakingLetNothingDrift)
  {
    Press<Sph::NsphMethod<2>> press_it(press("0; -0.03*sin(pi*t/10)^2*max(0, min(1, (200 - t)/10))"), {},
                                       steps_to(400.));
    double                    first = 0., last = 0.;
    for (unsigned int step = 1; step <= 800; ++step)
      {
        press_it.go_to(.25 * step);
        if (step % 20 == 0 && step <= 760) // the last one stays above
          {
            EXPECT_EQ(press_it["contact_particles_block"] > 0., step % 40 == 20) << step;
          }
        if (step <= 40)
          keep_largest(first, press_it["strain_energy_J"]);
        else if (step > 720 && step <= 760)
          keep_largest(last, press_it["strain_energy_J"]);
      }
    press_it.go_to(250.);
    press_it.go_to(400.);
    EXPECT_NEAR(last, first, .01 * first);
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
    Press<Sph::SphMethod<2>> press_it(press("0; -0.04*sin(pi*min(t, 1)/2)"), {"SPH/Energy balance=true"}, 12.);
    for (const double t : {.1, .3, .6, 1., 4., 12.})
      press_it.go_to(t);
    const double expected = pressure((height - .02) / height);
    EXPECT_EQ(press_it["contact_particles_block"], 6.);
    EXPECT_NEAR(press_it["contact_force_block_y_N"], .3 * expected, .3 * .02 * expected);
    EXPECT_NEAR(press_it["contact_pressure_max_block_Pa"], expected, .02 * expected);
    const double work = press_it["work_J"];
    EXPECT_NEAR(press_it["kinetic_energy_J"] + press_it["strain_energy_J"] + press_it["dissipated_energy_J"], work,
                .02 * work);
  }

  TEST(Contact, MpiAThrownBodyIsThrownBackAndNoEnergyIsLost)
  {
    auto text = press("0; 0");
    for (const auto &[from, to] : std::vector<std::pair<std::string, std::string>>{
           {" subsection drive\n  set Where = body block\n  set Displacement = 0; 0\n end\n", ""},
           {"  set Rigid = true\n", "  set Rigid = true\n  set Mass = 0.1\n  set Initial velocity = 0; -0.05\n"},
           {"Viscosity = 1\n", "Viscosity = 0.02\n"}})
      text.replace(text.find(from), from.size(), to);
    Press<Sph::SphMethod<2>> throw_it(text, {"SPH/Energy balance=true"}, 4.);
    const double             whole = throw_it["kinetic_energy_J"];
    EXPECT_NEAR(whole, .5 * .1 * .05 * .05, 1e-12);
    double most_strained = 0.;
    for (unsigned int step = 1; step <= 40; ++step)
      {
        throw_it.go_to(.1 * step);
        const double strained = throw_it["strain_energy_J"];
        keep_largest(most_strained, strained);
        // Symplectic Euler has velocities half a part ahead of the places: 2 % where energy flows fastest.
        EXPECT_NEAR(throw_it["kinetic_energy_J"] + strained + throw_it["dissipated_energy_J"], whole, .03 * whole)
          << step;
      }
    EXPECT_NEAR(throw_it["kinetic_energy_J"] + throw_it["strain_energy_J"] + throw_it["dissipated_energy_J"], whole,
                .01 * whole);
    EXPECT_GT(most_strained, .5 * whole);
    EXPECT_EQ(throw_it["work_J"], 0.);
    EXPECT_EQ(throw_it["contact_particles_block"], 0.);
    EXPECT_GT(throw_it["block_velocity_y_m_per_s"], .02);
    EXPECT_LT(throw_it["block_velocity_y_m_per_s"], .05);
  }

  // The second row enters with the first: as far as the wall goes ahead for that one, it does for it as well. 3 % are missing: geometry is
  // that of the step's start, where the wall is further off.
  TEST(Contact, MpiWhatClosesTheGapMakesNoStressBelowTheSurface)
  {
    Press<Sph::NsphMethod<2>> press_it(press("0; -0.0055*min(t, 2) - 0.0095*max(0, min(t - 2, 1))"), {},
                                       steps_to(1000.));
    for (const double t : {1., 2., 3., 50., 1000.})
      press_it.go_to(t);
    const double expected = pressure((height - .0005) / height);
    EXPECT_EQ(press_it["contact_particles_block"], 6.);
    EXPECT_NEAR(press_it["contact_pressure_max_block_Pa"], expected, .05 * expected);
  }

  // The ram comes from far in one step, where it touches particles that are in touch with the floor already.
  TEST(Contact, WhatComesNearLeavesOtherContactsAsTheyAre)
  {
    auto text = press("0; 0.0005*min(t, 1)");
    for (
      const auto &[from, to] : std::vector<std::pair<std::string, std::string>>{
        {"subsection Periodic\n set Directions = x\nend\n", ""},
        {"side y-min", "side x-min"},
        {"Upper corner = 0.3, 0.5", "Upper corner = 0.5, 0.5"},
        {"Upper corner = 0.6, 0.72\n  set Lower corner = -0.3, 0.52",
         "Lower corner = 0.25, -0.15\n  set Upper corner = 0.65, 0"},
        {"  set Rigid = true\n end\n",
         "  set Rigid = true\n end\n subsection ram\n  set Shape = box\n  set Lower corner = 0.508, 0.005\n  set Upper corner = 0.7, 0.5\n"
         "  set Rigid = true\n end\n"},
        {"subsection Supports\n", "subsection Supports\n subsection hit\n  set Where = body ram\n  set Displacement = "
                                  "-0.008005*max(0, min(t - 2, 1)); 0\n end\n"},
        {"subsection Contact\n",
         "subsection Contact\n subsection strike\n  set Body = ram\n  set Type = stick\n end\n"}})
      text.replace(text.find(from), from.size(), to);
    Press<Sph::NsphMethod<2>> press_it(text, {}, steps_to(4.));
    for (const double t : {1., 2.})
      press_it.go_to(t);
    const double before = press_it["strain_energy_J"];
    EXPECT_GT(press_it["contact_particles_block"], 0.);
    EXPECT_EQ(press_it["contact_particles_ram"], 0.);
    for (const double t : {3., 4.})
      press_it.go_to(t);
    EXPECT_GT(press_it["contact_particles_ram"], 0.);
    EXPECT_NEAR(press_it["strain_energy_J"], before, .1 * before);
  }

  /// A block of three spacings above a strip of twelve, endless along x, that goes sideways by @p aside and then down.
  double
  force_of_stamp(const double aside)
  {
    auto text = press(std::to_string(aside) + "*min(t, 1); -0.04*max(0, min(t - 1, 1))");
    for (const auto &[from, to] :
         std::vector<std::pair<std::string, std::string>>{{"Lower corner = -0.3, 0.52", "Lower corner = 0.2, 0.52"},
                                                          {"Upper corner = 0.6, 0.72", "Upper corner = 0.35, 0.72"},
                                                          {"Upper corner = 0.3, 0.5", "Upper corner = 0.6, 0.5"}})
      text.replace(text.find(from), from.size(), to);
    Press<Sph::NsphMethod<2>> press_it(text, {}, steps_to(4.));
    for (double t = .015625; t <= 1.; t += .015625)
      press_it.go_to(t);
    for (double t = 1.0625; t <= 2.; t += .0625)
      press_it.go_to(t);
    press_it.go_to(4.);
    return press_it["contact_force_block_y_N"];
  }

  TEST(Contact, ABodyTouchesAcrossAPeriodicFaceAsInside)
  {
    const double inside = force_of_stamp(0.);
    EXPECT_GT(inside, .001);
    EXPECT_NEAR(force_of_stamp(.35), inside, 1e-5 * inside); // from .55 to .7 of .6
  }

  TEST(Contact, MpiByDistanceNoStepIsSolvedForEver)
  {
    Press<Sph::NsphMethod<2>> press_it(press("0; -0.03*min(t, 1)"), {"NSPH/Contact/Criterion=heck"}, steps_to(2.));
    for (double t = .125; t <= 2.; t += .125)
      press_it.go_to(t);
    EXPECT_EQ(press_it["contact_particles_block"], 18.);
  }

  // Held along x as the plate is, particles do not move along it: what slides at the start of a step has no way.
  TEST(Contact, FrictionOfParticlesThatRestIsANumber)
  {
    auto text = rub(.02);
    for (const auto &[from, to] : std::vector<std::pair<std::string, std::string>>{
           {"subsection Supports\n", "subsection Supports\n subsection top\n  set Where = box 0, 0.4 : 0.3, 0.5\n"
                                     "  set Displacement = 0; free\n end\n"},
           {"Type = clamp", "Displacement = 0.004*min(t/4, 1); 0.002*min(t/4, 1)"},
           {"0.001*max(0, t - 20); -0.04*min(t, 1)", "0; 0"},
           {"Lower corner = -0.3, 0.52", "Lower corner = -0.3, 0.5"},
           {"Young's modulus = 1", "Young's modulus = 1e6"},
           {"Viscosity = 1", "Viscosity = 1e6"}})
      text.replace(text.find(from), from.size(), to);
    Press<Sph::NsphMethod<2>> press_it(text, {}, steps_to(10.));
    for (double t = .5; t <= 6.; t += .5)
      press_it.go_to(t);
    EXPECT_TRUE(std::isfinite(press_it["block_force_x_N"]));
  }
} // namespace
