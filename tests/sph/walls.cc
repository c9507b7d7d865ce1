// A wall's motion acts at the wall: sides that stretch, shear and turn the material, beside lattices and disordered particles.

#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  const double stiffness = 1., contraction = 0.;

  /// A unit square of stiffness 1 without lateral contraction.
  std::string
  square(const std::string &more, const double viscosity = 1.)
  {
    return scene_of(hypoelastic("gel", stiffness, contraction,
                                "  set Density = 1\n  set Viscosity = " + shortest(viscosity) + "\n"),
                    box_body("block", "1, 1")) +
           "subsection NSPH\n set Spacing = 0.05\nend\nsubsection SPH\n set Spacing = 0.1\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-10\nend\n" +
           more;
  }

  std::string
  moved(const std::string &side, const std::string &displacement)
  {
    return " subsection " + side + "\n  set Where = side " + side + "\n  set Displacement = " + displacement +
           "\n end\n";
  }

  std::string
  stretched(const std::string &motion)
  {
    return "subsection Periodic\n set Directions = x\nend\nsubsection Supports\n" + moved("y-min", "0; 0") +
           moved("y-max", "0; " + motion) + "end\n";
  }

  /// Stress of a stretch with the sides held [Pa], of the law 'hypoelastic'.
  double
  confined_stress(const double stretch)
  {
    const double K = stiffness / (3. * (1. - 2. * contraction)), G = stiffness / (2. * (1. + contraction));
    return K * (1. - 1. / stretch) + 4. / 3. * G * std::log(stretch);
  }

  /// Reaction of the upper side of the square after a ramp to t = 1 and rest [N/m].
  template <typename Method, typename Time>
  double
  reaction(const std::string &text, const std::vector<std::string> &set, const Time &time,
           const std::vector<double> &times)
  {
    ParticleScene<2> scene(text, set);
    Timers           timers;
    Open<Method>     method(scene.parameters, scene.scene, time, timers);
    StepWork         work;
    method.setup(nullptr);
    double t = 0.;
    for (const double next : times)
      {
        EXPECT_EQ(method.advance(t, next, work), StepStatus::ok);
        t = next;
      }
    return method.system->reactions().of_supports[1][1];
  }

  TEST(Walls, MpiAMotionThatVariesTowardsTheWallIsThatOfTheWall)
  {
    const std::vector<double> times = {.25, .5, .75, 1., 50., 100.};
    for (const std::string motion : {"0.001*y*min(t, 1)", "0.001*min(t, 1)"})
      for (const std::vector<std::string> &set : std::vector<std::vector<std::string>>{
             {"NSPH/Arrangement=square"}, {"NSPH/Arrangement=hexagonal"}, {"NSPH/Jitter=0.2"}, {"NSPH/Walls=facets"}})
        {
          const double tolerance = set[0] == "NSPH/Jitter=0.2" ? 1e-2 : 1e-3;
          EXPECT_NEAR(reaction<Sph::NsphMethod<2>>(square(stretched(motion)), set, steps_to(100.), times),
                      confined_stress(1.001), tolerance * confined_stress(1.001))
            << motion << ", " << set[0];
        }
  }

  // 10 % of stretch: .12463 Pa, where neo-Hookean has .118142 and St. Venant-Kirchhoff .155481.
  TEST(Walls, AStretchHasTheStressOfTheLawHypoelastic)
  {
    std::vector<double> times;
    for (unsigned int k = 1; k <= 40; ++k)
      times.push_back(k / 40.);
    times.insert(times.end(), {50., 100.});
    const double K = 1. / 1.2, G = 1. / 2.6, stress = K * (1. - 1. / 1.1) + 4. / 3. * G * std::log(1.1);
    EXPECT_NEAR(reaction<Sph::NsphMethod<2>>(square(stretched("0.1*min(t, 1)")), {"Materials/gel/Poisson's ratio=0.3"},
                                             steps_to(100.), times),
                stress, 3e-3 * stress);
  }

  TEST(Walls, AMotionThatVariesTowardsTheWallOfInertialParticles)
  {
    for (const std::string motion : {"0.001*y*min(t, 1)", "0.001*min(t, 1)"})
      EXPECT_NEAR(reaction<Sph::SphMethod<2>>(square(stretched(motion), .1), {}, 8., {1., 2., 4., 8.}),
                  confined_stress(1.001), 1e-3 * confined_stress(1.001))
        << motion;
  }

  /// Gradient of the velocities of a block whose sides all move by A X t, particles inside with them, from @p from to 1: root
  /// mean square of its difference from A (1 + A from)^-1, over |A|.
  double
  error_of_gradient(const dealii::Tensor<2, 2> &A, const double jitter, const double from,
                    const Sph::Walls walls = Sph::Walls::layers)
  {
    const auto number = [](const double value) { return "(" + std::to_string(value) + ")"; };
    const auto motion = "(" + number(A[0][0]) + "*x+" + number(A[0][1]) + "*y)*t; (" + number(A[1][0]) + "*x+" +
                        number(A[1][1]) + "*y)*t";
    std::string supports;
    for (const std::string side : {"x-min", "x-max", "y-min", "y-max"})
      supports += moved(side, motion);
    ParticleScene<2> scene(square("subsection Supports\n" + supports + "end\n"));
    Sph::Settings    settings;
    settings.arrangement.spacing = .05;
    settings.arrangement.jitter  = jitter;
    settings.walls               = walls;
    Timers         timers;
    Sph::System<2> system(scene.scene, settings, Sph::Dynamics::overdamped, 1., timers);
    system.arrange();
    EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
    const auto &p    = system.particles;
    const auto  move = [&](const double t, const double t_next) {
      system.set_step(t, t_next);
      Sph::System<2>::Velocities v(p.size());
      for (unsigned int i = 0; i < p.n_free; ++i)
        v[i] = A * dealii::Tensor<1, 2>(p.X[i]);
      system.impose(v);
      return v;
    };
    if (from > 0.)
      {
        const auto v = move(0., from);
        system.set_gradient(v);
        system.commit(v, from);
      }
    for (unsigned int k = 0; k < 4; ++k)
      EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
    const auto                        v = move(from, 1.);
    std::vector<dealii::Tensor<2, 2>> L(system.pairs.n_rows());
    system.elasticity->velocity_gradient(L, v);
    dealii::Tensor<2, 2> F = from * A;
    F[0][0] += 1.;
    F[1][1] += 1.;
    const auto exact   = A * invert(F);
    double     sums[2] = {0., 0.};
    for (unsigned int i = 0; i < p.n_free; ++i)
      {
        sums[0] += (L[i] - exact).norm_square();
        sums[1] += exact.norm_square();
      }
    dealii::Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
    return std::sqrt(sums[0] / sums[1]);
  }

  TEST(Walls, MpiSidesThatStretchShearAndTurn)
  {
    const dealii::Tensor<2, 2> stretch{{{0., 0.}, {0., .1}}}, shear{{{0., .1}, {0., 0.}}},
      all{{{.1, -.06}, {.04, -.05}}};
    for (const auto &A : {stretch, shear, all})
      for (const double from : {0., .9})
        {
          EXPECT_LT(error_of_gradient(A, 0., from), 1e-2);
          EXPECT_LT(error_of_gradient(A, .3, from), 4e-2);
          EXPECT_LT(error_of_gradient(A, 0., from, Sph::Walls::facets), 1e-3);
          EXPECT_LT(error_of_gradient(A, .3, from, Sph::Walls::facets), 5e-3);
        }
  }

  // A disc that turns and a side at rest, once the material has moved with the disc.
  TEST(Walls, MpiPairsKnowWhatTheyEndAt)
  {
    std::string text = square(
      "subsection Supports\n subsection y-min\n  set Where = side y-min\n  set Type = clamp\n end\n subsection turn\n"
      "  set Where = body disc\n  set Displacement = 0.02*t; 0\n  set Rotation = 0.1*t\n end\nend\n");
    text.insert(
      text.find("end\nsubsection NSPH"),
      " subsection disc\n  set Shape = ball\n  set Centre = 0.5, 0.5\n  set Radius = 0.2\n  set Rigid = true\n end\n");
    ParticleScene<2> scene(text);
    Sph::Settings    settings;
    settings.arrangement.spacing = .05;
    Timers         timers;
    Sph::System<2> system(scene.scene, settings, Sph::Dynamics::overdamped, 1., timers);
    system.arrange();
    EXPECT_EQ(system.update_geometry(true), StepStatus::ok);
    system.set_step(0., 1.);
    Sph::System<2>::Velocities v(system.particles.size());
    system.impose(v);
    system.set_gradient(v);
    system.commit(v, 1.);
    EXPECT_EQ(system.update_geometry(true), StepStatus::ok);

    const auto  &pairs = system.pairs;
    unsigned int n[2]  = {0, 0};
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
        {
          const auto &wall = pairs.wall(p);
          const auto &x    = system.particles.x[i];
          ++n[wall.mover];
          if (!system.movers[wall.mover].rigid)
            {
              EXPECT_NEAR((wall.normal - dealii::Point<2>(0., 1.)).norm(), 0., 1e-14);
              EXPECT_NEAR(wall.gap, x[1], 1e-14);
              EXPECT_NEAR((wall.X - x - pairs.r[p]).norm(), 0., 1e-12);
              continue;
            }
          const auto from_axis = x - dealii::Point<2>(.52, .5);
          EXPECT_NEAR((wall.normal - from_axis / from_axis.norm()).norm(), 0., 1e-10);
          EXPECT_NEAR(wall.gap, from_axis.norm() - .2, 1e-10);
          EXPECT_NEAR((system.poses[wall.mover].place(wall.X) - x - pairs.r[p]).norm(), 0., 1e-10);
        }
    EXPECT_GT(dealii::Utilities::MPI::sum(n[0], MPI_COMM_WORLD), 100u);
    EXPECT_GT(dealii::Utilities::MPI::sum(n[1], MPI_COMM_WORLD), 100u);
  }
} // namespace
