// The solid's equations together: patch test, standing wave, energy, creep, resuming.

#include "../base/keep_largest.h"
#include "solid_fixture.h"

#include <stroma/simulation/saved_state.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

namespace
{
  using namespace Stroma;

  const std::string tight = "subsection Newton\n set Displacement tolerance = 1e-10\n set Energy tolerance = 1e-14\n"
                            " set Inexact = false\nend\nsubsection Linear solver\n set Tolerance = 1e-12\nend\n";

  /// A square of degree @p k with distorted inner vertices and hanging nodes, its sides moved by an affine displacement.
  double
  patch_error(const std::string &material, const std::string &fem)
  {
    const std::string affine   = "0.2*x+0.1*y; 0.15*y-0.1*x";
    std::string       supports = "subsection Supports\n";
    for (const std::string side : {"x-min", "x-max", "y-min", "y-max"})
      supports += " subsection " + side + "\n  set Where = side " + side + "\n  set Displacement = " + affine +
                  "\n end\n";
    PartsFixture<2>        s(one("Materials", "gel", material) +
                             one("Bodies", "block", "  set Shape = quadrilateral\n  set Corners = 0, 0, 1, 0, 1, 1, 0, 1\n") +
                             supports + "end\nsubsection FEM\n set Cells = 3, 3\n" + fem + "end\n");
    const double           shift[4][2] = {{.05, -.07}, {-.06, -.04}, {.08, .05}, {-.03, .09}};
    unsigned int           inner       = 0;
    std::set<unsigned int> seen;
    for (const auto &cell : s.mesh.triangulation.active_cell_iterators())
      for (const unsigned int v : cell->vertex_indices())
        {
          auto &X = cell->vertex(v);
          if (X[0] > 1e-9 && X[0] < 1. - 1e-9 && X[1] > 1e-9 && X[1] < 1. - 1e-9 &&
              seen.insert(cell->vertex_index(v)).second)
            {
              X[0] += shift[inner][0];
              X[1] += shift[inner++][1];
            }
        }
    EXPECT_EQ(inner, 4u);
    for (const unsigned int level : {0, 1})
      {
        for (const auto &cell : s.mesh.triangulation.active_cell_iterators())
          if (cell->center().distance({.4, .6}) < .3 / (level + 1))
            cell->set_refine_flag();
        s.mesh.refine();
      }
    s.number();
    EXPECT_GT(s.unknowns->ties.n_constraints(), 8u);
    Fem::SolidSystem<2> system(s.scene, s.settings, s.mesh, *s.unknowns, s.timers);
    Vector              u = system.new_vector();
    Solvers::Stage      stage;
    stage.t = 1.;
    if (s.settings.order != Solvers::Order::statics)
      stage.v_factor = 1.;
    stage.v_known = stage.a_known = system.new_vector();
    system.set_stage(stage, 1., u);
    Matrix                        K;
    Solvers::NewtonSettings       newton_settings;
    Solvers::LinearSolverSettings linear_settings;
    newton_settings.inexact                = false;
    newton_settings.displacement_tolerance = newton_settings.energy_tolerance = 1e-14;
    linear_settings.tolerance                                                 = 1e-13;
    Solvers::LinearSolver linear_solver(linear_settings);
    linear_solver.set_near_null_space(s.unknowns->rigid_motions());
    const Solvers::Newton newton(newton_settings, [](auto...) {});
    EXPECT_EQ(newton.solve(system, linear_solver, K, u).status, StepStatus::ok);
    s.unknowns->distribute(u);
    double worst = 0.;
    for (const auto &[dof, component, X] : s.unknowns->owned_nodes())
      keep_largest(worst, std::abs(u(dof) - s.scene.supports[0].displacement.value(X, 1., component)));
    return worst;
  }

  TEST(SolidMethod, AnAffineBoundaryGivesAnAffineInside)
  {
    const std::string elastic = "  set Shear modulus = 2\n  set Bulk modulus = 5\n";
    double            worst   = 0.;
    for (const std::string &material : {elastic, elastic + "  set Viscosity = 0.7\n",
                                        elastic + "  set Viscosity = 0.7\n  set Viscous operator = morris\n",
                                        elastic + "  set Viscosity = 0.7\n  set Viscous operator = deviatoric\n",
                                        "  set Law = Prony\n" + elastic + "  set Kelvin-Voigt viscosity = 1\n"})
      for (const std::string k : {"1", "2", "3"})
        for (const std::string kinematics : {"finite", "small"})
          for (const std::string dilatation : {"full", "projected"})
            {
              const double error = patch_error(material, " set Degree = " + k + "\n set Kinematics = " + kinematics +
                                                           "\n set Dilatation = " + dilatation + "\n");
              EXPECT_LT(error, 1e-10) << material << k << kinematics << dilatation;
              keep_largest(worst, error);
            }
    std::cout << "patch test: largest error " << worst << " m" << std::endl;
  }

  /// A bar between walls, fixed at both ends, that starts with the velocity of its first mode:
  /// u = A sin(c k t) sin(k x), k = pi, c = sqrt(M / rho), M = kappa + 4/3 mu.
  const double      wave_speed = std::sqrt((5. + 4. / 3. * 2.) / 3.), amplitude = .01;
  const std::string bar = gel("  set Density = 3\n") +
                          one("Bodies", "bar",
                              "  set Shape = box\n  set Upper corner = 1, 0.25\n  set Initial velocity = 0.01*" +
                                std::to_string(wave_speed) + "*pi*sin(pi*x); 0\n") +
                          "subsection Supports\n subsection ends\n  set Where = side x-min\n  set Type = clamp\n end\n"
                          " subsection end\n  set Where = side x-max\n  set Displacement = 0; free\n end\n"
                          " subsection y0\n  set Where = side y-min\n  set Type = symmetry\n end\n"
                          " subsection y1\n  set Where = side y-max\n  set Type = symmetry\n end\nend\n" +
                          tight;

  /// Largest error of displacement (over A) and velocity (over its size) after .8 of a period.
  std::array<double, 2>
  wave_error(const std::string &scheme, const unsigned int n_steps, const double end)
  {
    SolidFixture<2> s(
      bar + "subsection FEM\n set Cells = 6, 1\n set Degree = 4\n set Kinematics = small\n set Inertia = true\n" +
      scheme + "end\n");
    s.method->setup(nullptr);
    EXPECT_TRUE(s.advance(0., end, n_steps));
    const auto            samples = sampled(*s.method, 2, {"displacement", "velocity"},
                                            {{{.2, .1, 0.}}, {{.35, .1, 0.}}, {{.5, .1, 0.}}, {{.9, .1, 0.}}});
    std::array<double, 2> error{};
    const double          omega = wave_speed * M_PI;
    for (std::size_t i = 0; i < samples.X.size(); ++i)
      {
        const double shape = amplitude * std::sin(M_PI * samples.X[i][0]);
        keep_largest(error[0], std::abs(samples.values[4 * i] - shape * std::sin(omega * end)) / amplitude);
        keep_largest(error[1], std::abs(samples.values[4 * i + 2] / omega - shape * std::cos(omega * end)) / amplitude);
      }
    return error;
  }

  TEST(SolidMethod, AStandingWaveConvergesWithOrder2)
  {
    const double period = 2. / wave_speed;
    for (const std::string scheme : {" set Scheme = Newmark\n", " set Scheme = generalized alpha\n",
                                     " set Scheme = generalized alpha\n set Spectral radius = 0.5\n"})
      {
        const auto coarse = wave_error(scheme, 40, .8 * period), fine = wave_error(scheme, 80, .8 * period);
        for (const unsigned int i : {0, 1})
          EXPECT_NEAR(std::log2(coarse[i] / fine[i]), 2., .1) << scheme << coarse[i] << ' ' << fine[i];
      }
  }

  /// Errors of reaction (over its size) and strain energy (over the whole) of the standing wave after .8 of a period.
  std::array<double, 2>
  wave_result_error(const unsigned int n_steps)
  {
    const double    end = .8 * 2. / wave_speed, phase = .8 * 2. * M_PI, modulus = 5. + 4. / 3. * 2.;
    SolidFixture<2> s(
      bar + "subsection FEM\n set Cells = 6, 1\n set Degree = 4\n set Kinematics = small\n set Inertia = true\n"
            " set Spectral radius = 0.5\nend\n");
    s.method->setup(nullptr);
    EXPECT_TRUE(s.advance(0., end, n_steps));
    const double pull   = modulus * amplitude * M_PI * .25; // of the stress at the ends
    const double energy = .25 * modulus * std::pow(amplitude * M_PI, 2) * .25;
    auto         result = s.scalars();
    return {{std::abs(result["reaction_ends_x_N"] / pull + std::sin(phase)),
             std::abs(result["strain_energy_J"] / energy - std::pow(std::sin(phase), 2))}};
  }

  TEST(SolidMethod, GeneralizedAlphaReportsTheEndOfItsStep)
  {
    const auto coarse = wave_result_error(40), fine = wave_result_error(80);
    for (const unsigned int i : {0, 1})
      EXPECT_GT(std::log2(coarse[i] / fine[i]), 1.8) << coarse[i] << ' ' << fine[i];
    EXPECT_LT(fine[0], 3e-3);
  }

  /// Reaction of the driven side of a viscous block after @p n_steps.
  double
  driven_reaction(const std::string &scheme, const unsigned int n_steps)
  {
    SolidFixture<2> s(
      gel("  set Viscosity = 1\n") + one("Bodies", "block", "  set Shape = box\n") +
      "subsection Supports\n subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n"
      " subsection top\n  set Where = side y-max\n  set Displacement = 0.05*sin(3*t); 0.05*(1-cos(2*t))\n end\n"
      "end\n" +
      tight + "subsection FEM\n set Cells = 2, 2\n set Scheme = " + scheme + "\nend\n");
    s.method->setup(nullptr);
    EXPECT_TRUE(s.advance(0., 1., n_steps));
    return s.scalars()["reaction_top_y_N"];
  }

  TEST(SolidMethod, ReactionsOfDrivenViscousSidesHaveTheSchemesOrder)
  {
    for (const auto &[scheme, order] : {std::make_pair("SDIRK 2", 2.), std::make_pair("SDIRK 3", 3.)})
      {
        const double n8 = driven_reaction(scheme, 8), n16 = driven_reaction(scheme, 16),
                     n32 = driven_reaction(scheme, 32);
        EXPECT_GT(std::log2(std::abs(n8 - n16) / std::abs(n16 - n32)), order - .4)
          << scheme << ' ' << n8 << ' ' << n16 << ' ' << n32;
      }
  }

  TEST(MpiSolidMethod, NewmarkKeepsTheEnergy)
  {
    SolidFixture<2> s(
      bar + "subsection FEM\n set Cells = 6, 2\n set Kinematics = small\n set Inertia = true\n set Scheme = Newmark\n" +
      " subsection Refinement\n  subsection spot\n   set Where = nearest 0.3, 0.1\n  end\n end\nend\n");
    s.method->setup(nullptr);
    const auto   start = s.scalars();
    const double whole = start.at("kinetic_energy_J");
    // .5 rho v^2 over the bar, and nothing else at the start.
    EXPECT_NEAR(whole, .25 * .5 * 3. * std::pow(amplitude * wave_speed * M_PI, 2) * .5, 1e-3 * whole);
    double least = whole;
    for (unsigned int i = 0; i < 20; ++i)
      {
        ASSERT_TRUE(s.advance(.07 * i, .07 * (i + 1)));
        const auto now = s.scalars();
        EXPECT_NEAR(now.at("kinetic_energy_J") + now.at("strain_energy_J"), whole, 1e-10 * whole);
        least = std::min(least, now.at("kinetic_energy_J"));
      }
    EXPECT_LT(least, .1 * whole);
  }

  TEST(MpiSolidMethod, AResumedRunRepeatsTheUninterruptedOne)
  {
    const std::string load = one("Loads", "push",
                                 "  set Where = ball 0.6, 0.1 : 0.1\n  set Total force = 0.01*sin(t); 0.02\n");
    const std::string fem  = "subsection FEM\n set Cells = 6, 2\n set Error cycles = 2\n";
    for (const std::string inertia : {" set Inertia = true\n", " set Inertia = true\n set Kinematics = small\n", ""})
      {
        auto       scene = bar + load + fem + inertia + "end\n";
        const auto start = scene.find("  set Initial velocity");
        if (inertia.empty())
          scene.erase(start, scene.find('\n', start) - start);
        const auto path = std::filesystem::temp_directory_path() /
                          ("stroma_solid_" + std::to_string(dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD)));
        SolidFixture<2> whole(scene), resumed(scene);
        whole.method->setup(nullptr);
        ASSERT_TRUE(whole.advance(0., .3, 3));
        {
          Output::ArchiveWriter archive(path, MPI_COMM_WORLD);
          save_state(*whole.method, archive, MPI_COMM_WORLD);
          archive.commit();
        }
        {
          const Output::ArchiveReader archive(path, MPI_COMM_WORLD);
          load_state(*resumed.method, archive, MPI_COMM_WORLD);
        }
        ASSERT_TRUE(whole.advance(.3, .5, 2));
        ASSERT_TRUE(resumed.advance(.3, .5, 2));
        EXPECT_EQ(resumed.method->scalars, whole.method->scalars) << inertia;
        MPI_Barrier(MPI_COMM_WORLD);
        std::filesystem::remove(path);
      }
  }
} // namespace
