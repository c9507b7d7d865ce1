// Steps of NSPH and SPH: what a failed one leaves, and long ones.

#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

#include <gtest/gtest.h>

#include <map>

namespace
{
  using namespace Stroma;

  using Nsph        = Open<Sph::NsphMethod<2>>;
  using SphInertial = Open<Sph::SphMethod<2>>;

  std::string
  material(const std::string &name, const double E, const double nu)
  {
    return hypoelastic(name, E, nu, "  set Viscosity = 1\n  set Viscous operator = central\n  set Density = 1\n");
  }

  /// A square held at some sides, with one load on all of it.
  std::string
  square(const std::string &materials, const std::string &more_bodies, const std::string &force,
         const std::vector<std::string> &held = {"y-min"})
  {
    return scene_of(materials, box_body("block", "1, 1", "  set Material = soft\n") + more_bodies, clamped(held)) +
           "subsection Loads\n subsection push\n  set Where = all\n  set Force density = " + force +
           "\n end\nend\nsubsection NSPH\n set Spacing = 0.1\nend\nsubsection SPH\n set Spacing = 0.1\nend\n";
  }

  template <typename Method>
  void
  check_untouched(Method &method)
  {
    StepWork work;
    method.setup(nullptr);
    ASSERT_EQ(method.advance(0., .01, work), StepStatus::ok);
    ASSERT_EQ(method.advance(.01, .02, work), StepStatus::ok);
    const auto before  = method.system->particles;
    const auto scalars = method.scalars;
    const auto status  = method.advance(.02, 1., work);
    EXPECT_TRUE(status == StepStatus::moved_too_far || status == StepStatus::not_finite ||
                status == StepStatus::crushed);
    const auto &after = method.system->particles;
    ASSERT_EQ(before.n_owned, after.n_owned);
    std::map<std::uint64_t, unsigned int> where; // their order in memory is no part of the state
    for (unsigned int i = 0; i < after.n_owned; ++i)
      where[after.id[i]] = i;
    EXPECT_GT(method.system->largest_displacement(), 0.);
    for (unsigned int i = 0; i < before.n_owned; ++i)
      {
        ASSERT_EQ(where.count(before.id[i]), 1u);
        const unsigned int k = where[before.id[i]];
        EXPECT_EQ(before.x[i], after.x[k]);
        EXPECT_EQ(before.v[i], after.v[k]);
        EXPECT_EQ(before.J[i], after.J[k]);
        EXPECT_EQ(before.S[i], after.S[k]);
      }
    EXPECT_EQ(scalars, method.scalars);
    // And the run goes on from there.
    EXPECT_EQ(method.advance(.02, .03, work), StepStatus::ok);
  }

  // Moderate up to t = 0.03, huge at 1.
  const std::string sudden = "0; -10*t - 1e12*t^12";

  TEST(NsphMethod, MpiAFailedStepLeavesTheStateUntouched)
  {
    ParticleScene<2> scene(square(material("soft", 2.5, .3), "", sudden));
    Timers           timers;
    Nsph             method(scene.parameters, scene.scene, steps_to(1.), timers);
    check_untouched(method);
  }

  TEST(SphMethod, AFailedStepLeavesTheStateUntouched)
  {
    ParticleScene<2> scene(square(material("soft", 2.5, .3), "", sudden, {"x-min", "x-max", "y-min", "y-max"}));
    Timers           timers;
    SphInertial      method(scene.parameters, scene.scene, 1., timers);
    check_untouched(method);
  }

  /// Largest displacement after @p n steps of @p factor times the explicit limit [m]; infinite if one fails. The load acts at once.
  double
  after_steps(const std::string &text, const double factor, const unsigned int n,
              const std::vector<std::string> &set = {})
  {
    ParticleScene<2> scene(text, set);
    Timers           timers;
    auto             steps = steps_to(1.);
    steps.initial_step = steps.largest_step = 1e-3; // explicit ones are asked for here, step by step
    Nsph method(scene.parameters, scene.scene, steps, timers);
    method.setup(nullptr);
    const double dt = factor * Sph::NsphMethod<2>::explicit_limit(scene.scene, method.system->constitutions,
                                                                  method.system->settings);
    StepWork     work;
    for (unsigned int k = 0; k < n; ++k)
      if (method.advance(k * dt, (k + 1) * dt, work) != StepStatus::ok)
        return std::numeric_limits<double>::infinity();
    return method.system->largest_displacement();
  }

  TEST(NsphMethod, LongStepsOfUnlikeMaterialsReachTheEquilibrium)
  {
    const std::string stiff =
      " subsection core\n  set Shape = box\n  set Lower corner = .3, .3\n  set Upper corner = .7, .7\n  set Material = stiff\n end\n";
    const std::string text = square(material("soft", 1., .3) + material("stiff", 1e4, .3), stiff, "0.005; 0");
    // The stiff one sets the limit, 1e4 times shorter than the soft one's time: 10 soft times are 1e5 limits.
    for (const std::string scheme : {"backward Euler", "SDIRK 2"})
      {
        const double thousand = after_steps(text, 1e3, 1, {"NSPH/Scheme=" + scheme});
        EXPECT_GT(thousand, 0.);
        const double u = after_steps(text, 1e5, 4, {"NSPH/Scheme=" + scheme});
        EXPECT_LT(thousand, u);
        EXPECT_NEAR(after_steps(text, 2e4, 20, {"NSPH/Scheme=" + scheme}), u, .01 * u);
      }
  }

  TEST(NsphMethod, LongStepsOfANearlyIncompressibleMaterialReachTheEquilibrium)
  {
    const std::string text = square(material("soft", 1., .499), "", "0.003; 0");
    for (const std::string scheme : {"backward Euler", "SDIRK 2"})
      {
        const double u = after_steps(text, 1e3, 12, {"NSPH/Scheme=" + scheme});
        EXPECT_GT(u, 0.);
        EXPECT_NEAR(after_steps(text, 1e2, 120, {"NSPH/Scheme=" + scheme}), u, .02 * u);
      }
  }

  /// 2 E and the work of loads and of sides that have been moved, all of them once, at rest [J/m].
  std::pair<double, double>
  energy_and_work(const std::string &text)
  {
    ParticleScene<2> scene(text, {"NSPH/Jitter=.3", "NSPH/Formulation=consistent"});
    Timers           timers;
    Nsph             method(scene.parameters, scene.scene, steps_to(1e5), timers);
    StepWork         work;
    method.setup(nullptr);
    EXPECT_EQ(method.advance(0., 1e5, work), StepStatus::ok);
    EXPECT_EQ(method.advance(1e5, 2e5, work), StepStatus::ok);
    auto       &system = *method.system;
    double      done   = 0.;
    const auto &loads  = system.loads->force(system.particles, 2e5);
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      done += loads[i] * system.displacement(i);
    done                 = dealii::Utilities::MPI::sum(done, MPI_COMM_WORLD);
    const auto reactions = system.reactions().of_supports;
    for (unsigned int s = 0; s < reactions.size(); ++s)
      if (scene.scene.supports[s].name == "mover")
        done += 1e-4 * reactions[s][0];
    return {2. * system.strain_energy(), done};
  }

  TEST(NsphMethod, MpiStrainEnergyIsHalfTheWorkDone)
  {
    const auto loaded = energy_and_work(square(material("soft", 1., .3), "", "1e-4*sin(12*x); 1e-4*cos(20*y)"));
    EXPECT_NEAR(loaded.first, loaded.second, 2e-3 * loaded.second);
    // The whole of the top moves sideways, all at once.
    const std::string supports = "subsection Supports\n";
    auto              sideways = square(material("soft", 1., .3), "", "0; 0");
    sideways.insert(sideways.find(supports) + supports.size(),
                    " subsection mover\n  set Where = side y-max\n  set Displacement = 1e-4*min(t/1e5, 1); 0\n end\n");
    const auto moved = energy_and_work(sideways);
    EXPECT_NEAR(moved.first, moved.second, 2e-3 * moved.second);
  }

  // The velocities are those of the load: stresses have no time to grow.
  TEST(NsphMethod, MpiVelocitiesThatGrowSteadilyAreGuessedFromThoseBefore)
  {
    for (const std::string update : {"explicit", "implicit"})
      {
        ParticleScene<2> scene(square(material("soft", 1e-3, .3), "", "1e9*t; 0"), {"NSPH/Stress update=" + update});
        Timers           timers;
        Nsph             method(scene.parameters, scene.scene, steps_to(1e-8), timers);
        method.setup(nullptr);
        std::vector<unsigned long> iterations;
        for (const auto &[t, t_next] : std::vector<std::pair<double, double>>{{0., 1.}, {1., 2.}, {2., 4.}, {4., 5.}})
          {
            StepWork work;
            EXPECT_EQ(method.advance(1e-9 * t, 1e-9 * t_next, work), StepStatus::ok);
            iterations.push_back(work.linear_iterations);
          }
        if (update == "implicit")
          {
            EXPECT_GT(iterations[1],
                      10u); // after the first step there is but one state; explicit solves go by its force
          }
        EXPECT_LE(iterations[2], 2u); // what solves leave open grows on the way
        EXPECT_LE(iterations[3], 2u);
      }
  }

  /// Growth of the largest displacement from 240 steps of half the limit to 240 of @p factor times it, of waves of shear along x.
  double
  growth_of_shear(const double nu, const std::string &form, const double factor, const std::vector<std::string> &set)
  {
    const std::string text =
      scene_of(material("soft", 1., nu), box_body("block", "1, 1")) +
      "subsection Periodic\n set Directions = x, y\nend\n"
      "subsection Loads\n subsection wave\n  set Where = all\n  set Force density = 0; 1e-6*(sin(2*pi*x)+sin(9*2*pi*x))\n end\nend\n"
      "subsection NSPH\n set Spacing = 1/20\n set Stress update = explicit\nend\n";
    std::vector<std::string> all = set;
    all.push_back("Materials/soft/Viscous operator=" + form);
    return after_steps(text, factor, 240, all) / after_steps(text, .5, 240, all);
  }

  // Shear decides for nu < .25 with the central operator, hourglass control where 'Stabilisation' is large with the morris one.
  TEST(NsphMethod, ExplicitStepsOfShearAreStableUpToTheLimit)
  {
    for (const double nu : {-.4, 0.})
      {
        EXPECT_NEAR(growth_of_shear(nu, "central", .9, {}), 1., .02) << nu;
        EXPECT_GT(growth_of_shear(nu, "central", 1.1, {}), 50.) << nu;
      }
    EXPECT_NEAR(growth_of_shear(.3, "morris", .9, {"NSPH/Stabilisation=10"}), 1., .02);
    EXPECT_GT(growth_of_shear(.3, "morris", 1.1, {"NSPH/Stabilisation=10"}), 5.);
  }

  TEST(NsphMethod, MpiANetLoadThatNothingTakesUpIsRefused)
  {
    const std::string all_around = "subsection Periodic\n set Directions = x, y\nend\n";
    const auto text = message_of_setup(square(material("soft", 1., .3), "", "0.1*t; sin(2*pi*x)", {}) + all_around);
    EXPECT_EQ(text.find("test.prm:"), 0u) << text;
    EXPECT_NE(text.find("the loads sum up to"), std::string::npos) << text;
    EXPECT_EQ(message_of_setup(square(material("soft", 1., .3), "", "0; sin(2*pi*x)", {}) + all_around), "");
  }

  // The next step is proposed from the speeds, so that hardly one is solved in vain.
  TEST(NsphMethod, StepsThatMovesLimitAreProposed)
  {
    ParticleScene<2> scene(square(material("soft", 1., .3), "", "0.2; 0"));
    Timers           timers;
    Nsph             method(scene.parameters, scene.scene, steps_to(10.), timers);
    method.setup(nullptr);
    double       t = 0., dt = 10.;
    unsigned int n_taken = 0, n_failed = 0;
    while (t < 5. && n_taken + n_failed < 1000)
      {
        StepWork work;
        if (method.advance(t, t + dt, work) == StepStatus::ok)
          {
            t += dt;
            dt = std::min(2. * dt, work.longest_next);
            ++n_taken;
          }
        else
          {
            dt *= .5;
            n_failed += n_taken > 0;
          }
      }
    EXPECT_GT(n_taken, 5u);
    EXPECT_LE(5 * n_failed, n_taken);
  }

  TEST(NsphMethod, MpiSupportsThatShareParticles)
  {
    const auto layers = [](const std::string &second) {
      auto text = square(material("soft", 1., .3), "", "0; -0.01", {});
      return text.replace(
        text.find(clamped({})), clamped({}).size(),
        "subsection Supports\n subsection lower\n  set Where = layer y-min 0.2\n  set Type = clamp\n end\n"
        " subsection upper\n  set Where = box 0, 0.1 : 1, 0.3\n  set Displacement = " +
          second + "\n end\nend\n");
    };
    const auto text = message_of_setup(layers("0; 0.1*t"));
    EXPECT_NE(text.find("supports 'lower' and 'upper' contradict each other"), std::string::npos) << text;
    ParticleScene<2> scene(layers("0; 0"));
    Timers           timers;
    Nsph             method(scene.parameters, scene.scene, steps_to(1e3), timers);
    StepWork         work;
    method.setup(nullptr);
    EXPECT_EQ(method.advance(0., 1e3, work), StepStatus::ok);
    EXPECT_EQ(method.advance(1e3, 2e3, work),
              StepStatus::ok); // after one step forces balance but for the square of strains
    const auto reactions = method.system->reactions().of_supports;
    EXPECT_NEAR(reactions[0][1] + reactions[1][1], .01, 2e-5); // the weight, once
  }

  TEST(NsphMethod, ExplicitStepsAreStableUpToTheLimit)
  {
    const std::string text =
      scene_of(material("soft", 1., .3), box_body("block", "1, 1")) +
      "subsection Periodic\n set Directions = x, y\nend\n"
      "subsection Loads\n subsection wave\n  set Where = all\n  set Force density = 1e-6*sin(2*pi*x); 0\n end\nend\n"
      "subsection NSPH\n set Spacing = 1/40\n set Stress update = explicit\nend\n";
    // The limit is that of long waves, 1 % lower than that of this one. Above it each step turns the motion round and enlarges it.
    for (const std::string form : {"morris", "central"})
      {
        const std::vector<std::string> set     = {"Materials/soft/Viscous operator=" + form};
        const double                   settled = after_steps(text, .5, 60, set);
        EXPECT_NEAR(after_steps(text, .98, 300, set), settled, .01 * settled) << form;
        EXPECT_GT(after_steps(text, 1.02, 300, set), 50. * settled) << form;
      }
  }
} // namespace
