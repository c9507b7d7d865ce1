// Islands of particles and single ones: without inertia they stay where they are, with it they fall.

#include "../base/keep_largest.h"
#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace
{
  using namespace Stroma;

  using NsphOfIslands = Open<Sph::NsphMethod<2>>;

  std::string
  ball_of_islands(const std::string &name, const std::string &centre, const std::string &radius)
  {
    return " subsection " + name + "\n  set Shape = ball\n  set Centre = " + centre + "\n  set Radius = " + radius +
           "\n  set Material = soft\n end\n";
  }

  /// Five particles, and one.
  const std::string drop_and_crumb = ball_of_islands("drop", "3.05, .55", ".11") +
                                     ball_of_islands("crumb", "5.05, .55", ".05");

  /// A block that stands on its lower side, others beside it, and a load on what lies in @p where.
  std::string
  block_and(const std::string &others, const std::string &where, const std::string &force = "0; -0.01")
  {
    return scene_of(hypoelastic("soft", 1., .3,
                                "  set Viscosity = 1\n  set Viscous operator = central\n  set Density = 1\n"),
                    box_body("block", "1, 1", "  set Material = soft\n") + others) +
           "subsection Supports\n subsection floor\n  set Where = box 0, 0 : 1, 0.1\n  set Type = clamp\n end\nend\nsubsection Loads\n subsection push\n  set Where = " +
           where + "\n  set Force density = " + force +
           "\n end\nend\nsubsection NSPH\n set Spacing = 0.1\nend\nsubsection SPH\n set Spacing = 0.1\nend\n" +
           "subsection Linear solver\n set Tolerance = 1e-10\nend\n";
  }

  /// Places of all particles after a second, by id.
  std::map<std::uint64_t, dealii::Point<2>>
  places_with(const std::vector<std::string> &set)
  {
    ParticleScene<2> scene(block_and(drop_and_crumb, "box 0, 0 : 1, 1"), set);
    Timers           timers;
    StepWork         work;
    NsphOfIslands    method(scene.parameters, scene.scene, steps_to(1.), timers);
    method.setup(nullptr);
    for (unsigned int k = 0; k < 4; ++k)
      EXPECT_EQ(method.advance(.25 * k, .25 * (k + 1), work), StepStatus::ok);
    std::map<std::uint64_t, dealii::Point<2>> all;
    const auto                               &particles = method.system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        all[particles.id[i]] = particles.x[i];
        if (particles.X[i][0] > 2.)
          {
            EXPECT_EQ(particles.x[i], particles.X[i]);
            EXPECT_EQ(particles.J[i], 1.);
          }
      }
    return all;
  }

  TEST(Islands, MpiStayWhereTheyAre)
  {
    for (const std::string preconditioner : {"amg", "jacobi", "cholesky"})
      for (const std::string scheme : {"SDIRK 2", "backward Euler"})
        {
          std::vector<std::string> set    = {"Linear solver/Preconditioner=" + preconditioner, "NSPH/Scheme=" + scheme};
          const auto               places = places_with(set);
          set.insert(set.end(), {"Supports/rest/Where=box 2, 0 : 6, 1", "Supports/rest/Type=clamp"});
          double largest = 0., moved = 0.;
          for (const auto &[id, x] : places_with(set))
            {
              ASSERT_EQ(places.count(id), 1u);
              keep_largest(largest, x.distance(places.at(id)));
              keep_largest(moved, std::abs(x[1] - std::round(20. * x[1]) / 20.));
            }
          EXPECT_LT(largest, 1e-9) << preconditioner;
          EXPECT_GT(dealii::Utilities::MPI::max(moved, MPI_COMM_WORLD), 1e-4);
        }
  }

  // Stresses that are uneven, in a piece that is no even one, let it relax, but neither move nor turn it.
  TEST(Islands, MpiRelaxWithoutMovingOrTurning)
  {
    const std::string wedge =
      " subsection wedge\n  set Shape = box\n  set Lower corner = 3, 0\n  set Upper corner = 3.7, .4\n  set Material = soft\n end\n" +
      ball_of_islands("head", "3.7, .45", ".3");
    for (const std::string viscous : {"central", "morris"})
      {
        ParticleScene<2> scene(block_and(wedge, "box 0, 0 : 1, 1"),
                               {"Materials/soft/Viscous operator=" + viscous, "NSPH/Jitter=.2"});
        Timers           timers;
        StepWork         work;
        NsphOfIslands    method(scene.parameters, scene.scene, steps_to(10.), timers);
        method.setup(nullptr);
        auto &particles = method.system->particles;
        for (unsigned int i = 0; i < particles.n_owned; ++i)
          if (particles.X[i][0] > 2.)
            {
              particles.S[i][0][0] = .1 * (particles.X[i][1] + (particles.X[i][0] - 3.));
              particles.S[i][1][1] = -.1 * particles.X[i][1];
              particles.S[i][0][1] = .1 * std::sin(5. * particles.X[i][0]);
            }
        const double before = method.system->strain_energy();
        for (unsigned int k = 0; k < 5; ++k)
          ASSERT_EQ(method.advance(.1 * k, .1 * (k + 1), work), StepStatus::ok);
        EXPECT_LT(method.system->strain_energy(), .8 * before);
        std::vector<double> sums(5); // places, displacements, number
        for (unsigned int i = 0; i < particles.n_free; ++i)
          if (particles.X[i][0] > 2.)
            {
              for (unsigned int d = 0; d < 2; ++d)
                {
                  sums[d] += particles.X[i][d];
                  sums[2 + d] += particles.x[i][d] - particles.X[i][d];
                }
              sums[4] += 1.;
            }
        dealii::Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
        EXPECT_NEAR(sums[2] / sums[4], 0., 1e-12);
        EXPECT_NEAR(sums[3] / sums[4], 0., 1e-12);
        double turned = 0., moved = 0.;
        for (unsigned int i = 0; i < particles.n_free; ++i)
          if (particles.X[i][0] > 2.)
            {
              const auto v = particles.v[i];
              // about the mean of the places now, which is that of the places at the start
              turned += (particles.x[i][0] - sums[0] / sums[4]) * v[1] - (particles.x[i][1] - sums[1] / sums[4]) * v[0];
              moved += v.norm();
            }
        turned = dealii::Utilities::MPI::sum(turned, MPI_COMM_WORLD);
        moved  = dealii::Utilities::MPI::sum(moved, MPI_COMM_WORLD);
        EXPECT_GT(moved, 1e-3);
        EXPECT_LT(std::abs(turned), .01 * moved);
      }
  }

  TEST(Islands, MpiUnderALoadAreNamed)
  {
    const auto text = message_of_setup(block_and(drop_and_crumb, "all"));
    EXPECT_NE(text.find("loads push or turn an island of 5 particles of body 'drop'"), std::string::npos) << text;
    EXPECT_EQ(message_of_setup(block_and("", "all")), "");
    EXPECT_EQ(message_of_setup(block_and(drop_and_crumb, "box 0, 0 : 1, 1")), "");
    // No sum, but a moment.
    const auto turned = message_of_setup(
      block_and(drop_and_crumb, "all", "(x > 2)*(y - 0.55); (x > 2)*(3.05 - x)*(x < 4)"));
    EXPECT_NE(turned.find("of 5 particles"), std::string::npos) << turned;
    // Neither: stretched.
    EXPECT_EQ(message_of_setup(block_and(drop_and_crumb, "all", "(x > 2)*(x < 4)*(x - 3.05); (x > 2)*(y - .55)")), "");
  }

  TEST(Islands, MpiThatComeLooseUnderALoadEndTheRun)
  {
    for (const bool loaded : {true, false})
      {
        ParticleScene<2> scene(block_and("", loaded ? "all" : "box 0, 0 : 1, 0.5", "0; -0.01"));
        Timers           timers;
        NsphOfIslands    method(scene.parameters, scene.scene, steps_to(1.), timers);
        StepWork         work;
        method.setup(nullptr);
        ASSERT_EQ(method.advance(0., .1, work), StepStatus::ok);
        auto &particles = method.system->particles;
        for (unsigned int i = 0; i < particles.n_owned; ++i)
          if (particles.X[i][1] > .7)
            particles.x[i][1] += .4;
        const auto before = method.scalars;
        const auto status = loaded ? StepStatus::detached : StepStatus::ok;
        EXPECT_EQ(method.advance(.1, .2, work), status);
        EXPECT_EQ(method.advance(.1, .11, work), status);
        EXPECT_EQ(method.scalars == before, loaded);
      }
  }

  /// A strip that nothing holds, and plates of these names, above or below it, that move by @p motion of each.
  std::string
  strip_and_plates(const std::map<std::string, std::string> &motion)
  {
    std::string bodies, supports, contacts;
    for (const auto &[name, y] : motion)
      {
        const std::string lowest = name == "upper" ? "0.5" : "-0.3";
        bodies += " subsection " + name + "\n  set Shape = box\n  set Lower corner = -.5, " + lowest +
                  "\n  set Upper corner = 1.5, " + lowest + " + .3\n  set Rigid = true\n end\n";
        supports += " subsection " + name + "\n  set Where = body " + name + "\n  set Displacement = 0; " + y +
                    "\n end\n";
        contacts += " subsection " + name + "\n  set Body = " + name + "\n end\n";
      }
    return scene_of(hypoelastic("gel", 1., .3, "  set Viscosity = 0.1\n  set Density = 1\n"),
                    box_body("strip", "1, 0.5", "  set Material = gel\n") + bodies,
                    "subsection Supports\n" + supports + "end\nsubsection Contact\n" + contacts +
                      "end\nsubsection NSPH\n set Spacing = 0.1\nend\n");
  }

  // Two plates press it, let go of it and come back.
  TEST(Islands, MpiCycleOfContactThatLetsGo)
  {
    for (const std::vector<std::string> &set :
         {std::vector<std::string>(), std::vector<std::string>{"Periodic/Directions=x"}})
      {
        ParticleScene<2> scene(strip_and_plates({{"upper", "-0.05*sin(pi*t)"}, {"lower", "0.05*sin(pi*t)"}}), set);
        Timers           timers;
        NsphOfIslands    method(scene.parameters, scene.scene, steps_to(4.), timers);
        StepWork         work;
        method.setup(nullptr);
        std::vector<double> energies;
        for (unsigned int k = 0; k < 80; ++k)
          {
            ASSERT_EQ(method.advance(.05 * k, .05 * (k + 1), work), StepStatus::ok) << k;
            energies.push_back(method.system->strain_energy());
          }
        const auto peak = [&](const unsigned int cycle) {
          return *std::max_element(energies.begin() + 40 * cycle, energies.begin() + 40 * cycle + 40);
        };
        EXPECT_GT(peak(0), 1e-4);
        EXPECT_NEAR(peak(1), peak(0), .02 * peak(0));
        EXPECT_LT(energies.back(), .01 * peak(0));
        double      largest   = 0.;
        const auto &particles = method.system->particles;
        for (unsigned int i = 0; i < particles.n_free; ++i)
          keep_largest(largest, (particles.x[i] - particles.X[i]).norm());
        EXPECT_LT(dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD), 2e-3);
      }
  }

  // A plate pushes it ahead and goes away.
  TEST(Islands, MpiGoWhereTheyArePushed)
  {
    ParticleScene<2> scene(strip_and_plates({{"lower", "0.1*sin(pi*t)"}}));
    Timers           timers;
    NsphOfIslands    method(scene.parameters, scene.scene, steps_to(1.5), timers);
    StepWork         work;
    method.setup(nullptr);
    for (unsigned int k = 0; k < 60; ++k)
      ASSERT_EQ(method.advance(.025 * k, .025 * (k + 1), work), StepStatus::ok) << k;
    double      largest   = 0.;
    const auto &particles = method.system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      keep_largest(largest, (particles.x[i] - particles.X[i] - dealii::Tensor<1, 2>({0., .1})).norm());
    EXPECT_LT(dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD), 2e-3);
    EXPECT_LT(method.system->strain_energy(), 1e-8);
  }

  /// By SPH they fall on, each as one.
  TEST(Islands, MpiFallBySph)
  {
    ParticleScene<2>        scene(block_and(drop_and_crumb, "all"));
    Timers                  timers;
    Open<Sph::SphMethod<2>> method(scene.parameters, scene.scene, 1., timers);
    StepWork                work;
    method.setup(nullptr);
    ASSERT_EQ(method.advance(0., .5, work), StepStatus::ok);
    ASSERT_EQ(method.advance(.5, 1., work), StepStatus::ok);
    const auto  &particles = method.system->particles;
    unsigned int of_drop = 0, of_crumb = 0;
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      if (particles.X[i][0] > 2.)
        {
          ++(particles.X[i][0] > 4. ? of_crumb : of_drop);
          EXPECT_NEAR(particles.x[i][1] - particles.X[i][1], -.005, 1e-4);
          EXPECT_NEAR(particles.x[i][0] - particles.X[i][0], 0., 1e-6);
          EXPECT_NEAR(particles.J[i], 1., 1e-6);
        }
    EXPECT_EQ(dealii::Utilities::MPI::sum(of_drop, MPI_COMM_WORLD), 5u);
    EXPECT_EQ(dealii::Utilities::MPI::sum(of_crumb, MPI_COMM_WORLD), 1u);
  }
} // namespace
