// The published walls of rigid bodies: boundary particles, segments, and the stress on them (Heck 2017, 2.5).

#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  const double particle_spacing = .05, load = .02;

  const std::string disc =
    " subsection disc\n  set Shape = ball\n  set Centre = 0.5, 0.5\n  set Radius = 0.22\n  set Rigid = true\n end\n";
  /// A spacing above the first row.
  const std::string lid = " subsection plate\n  set Shape = box\n  set Lower corner = -0.5, 1.025\n"
                          "  set Upper corner = 1.5, 1.3\n  set Rigid = true\n end\n";

  /// A square with a rigid body in it, or above it.
  class Beside
  {
  public:
    explicit Beside(const std::string &body)
      : fixture(scene_of(hypoelastic("gel", 1., .3, "  set Density = 1\n  set Viscosity = 1\n"),
                         box_body("block", "1, 1") + body))
    {
      Sph::Settings settings;
      settings.arrangement.spacing = particle_spacing;
      settings.formulation         = Sph::Formulation::published;
      settings.kernel              = Sph::KernelName::cubic_spline;
      settings.walls               = Sph::Walls::facets;
      settings.stress_update       = Sph::StressUpdate::explicit_;
      system = std::make_unique<Sph::System<2>>(fixture.scene, settings, Sph::Dynamics::overdamped, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
    }

    ParticleScene<2>                fixture;
    Timers                          timers;
    std::unique_ptr<Sph::System<2>> system;
  };

  TEST(Segments, MpiBoundaryParticlesHaveTheVolumeThatTheirAngleLeaves)
  {
    const Beside scene(disc);
    const auto  &particles = scene.system->particles;
    double       volume = 0., n = 0.;
    for (unsigned int b = particles.n_free; b < particles.n_owned; ++b, ++n)
      {
        EXPECT_NEAR(particles.X[b].distance({.5, .5}), .22, 1e-12);
        volume += particles.V0[b];
      }
    volume = dealii::Utilities::MPI::sum(volume, MPI_COMM_WORLD);
    n      = dealii::Utilities::MPI::sum(n, MPI_COMM_WORLD);
    // n segments of a circle, at each of whose ends pi + 2 pi/n are outside.
    const double pi = dealii::numbers::PI, outline = n * 2. * .22 * std::sin(pi / n);
    EXPECT_NEAR(volume, outline * particle_spacing * (.5 + 1. / n), 1e-12);
    EXPECT_LE(outline / n, particle_spacing);
  }

  TEST(Segments, MpiAUniformStressIsThatOfSurfaces)
  {
    const Beside          scene(disc);
    auto                 &particles = scene.system->particles;
    SymmetricTensor<2, 2> S;
    S[0][0] = 1.;
    S[0][1] = -.3;
    S[1][1] = -.4;
    for (unsigned int i = 0; i < particles.size(); ++i)
      if (!particles.is_fixed(i))
        particles.S[i] = S;
    const auto  sigma = scene.system->stresses();
    const auto &pairs = scene.system->pairs;
    ASSERT_EQ(sigma.size(), pairs.n_points());
    for (unsigned int b = particles.n_free; b < particles.n_owned; ++b)
      EXPECT_LT((sigma[b] - S).norm(), 1e-12);
    for (unsigned int w = pairs.first_wall_point(); w < pairs.n_points(); ++w)
      EXPECT_LT((sigma[w] - S).norm(), 1e-12);
  }

  TEST(Segments, MpiNothingIsStrainedNorRubsWhereAllMovesAsOne)
  {
    const Beside              scene(disc);
    auto                     &system = *scene.system;
    std::vector<Tensor<2, 2>> L(system.pairs.n_rows());
    std::vector<Tensor<1, 2>> v(system.pairs.n_points(), Tensor<1, 2>({1., 2.})), f(system.particles.n_free);
    system.elasticity->velocity_gradient(L, v);
    system.add_friction(f, v);
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      {
        EXPECT_LT(L[i].norm(), 1e-10);
        EXPECT_LT(f[i].norm(), 1e-12);
      }
  }

  // A spacing off a flat wall, as the paper has it: 1.01 of the gradient across (1.2 on average beside a disc that cuts the lattice).
  TEST(Segments, MpiALinearMotionHasItsGradientASpacingOffAFlatWall)
  {
    const Beside              scene(lid);
    auto                     &system = *scene.system;
    const auto               &pairs  = system.pairs;
    std::vector<Tensor<2, 2>> L(pairs.n_rows());
    std::vector<Tensor<1, 2>> v(pairs.n_points());
    for (unsigned int k = 0; k < system.particles.size(); ++k)
      v[k][1] = system.particles.x[k][1];
    for (unsigned int w = 0; w < pairs.walls.size(); ++w)
      v[pairs.first_wall_point() + w][1] = pairs.walls[w].X[1];
    system.elasticity->velocity_gradient(L, v);
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      if (const auto x = system.particles.x[i]; std::abs(x[0] - .5) < .3 && x[1] > .9)
        {
          EXPECT_NEAR(L[i][1][1], 1., .05) << x;
          EXPECT_LT(pairs.row_factor(i), 1.) << x;
        }
  }

  // Rows over gamma are not symmetric with the body's: the force on it is the load all the same.
  TEST(Segments, MpiABodyThatIsPressedBearsItsLoad)
  {
    const std::string text =
      scene_of(hypoelastic("gel", 1., .3, "  set Density = 1\n  set Viscosity = 1\n  set Viscous operator = morris\n"),
               box_body("block", "1, 0.5") +
                 " subsection disc\n  set Shape = ball\n  set Centre = 0.5, 0.96\n  set Radius = 0.4\n"
                 "  set Rigid = true\n  set Largest approach = 0.005\n end\n") +
      "subsection Supports\n subsection floor\n  set Where = side y-min\n  set Type = clamp\n end\nend\n"
      "subsection Loads\n subsection weight\n  set Where = body disc\n  set Total force = 0; -" +
      std::to_string(load) +
      "\n end\nend\nsubsection Contact\n subsection touch\n  set Body = disc\n  set Type = stick\n end\nend\n"
      "subsection NSPH\n set Formulation = published\n set Walls = facets\n set Spacing = 0.05\nend\n"
      "subsection Linear solver\n set Tolerance = 1e-9\nend\n";
    ParticleScene<2>         scene(text);
    Timers                   timers;
    Open<Sph::NsphMethod<2>> method(scene.parameters, scene.scene, steps_of(.5, 80), timers);
    StepWork                 work;
    method.setup(nullptr);
    for (double t = 0.; t < 40.; t += .5)
      ASSERT_EQ(method.advance(t, t + .5, work), StepStatus::ok) << t;
    double force = 0.;
    for (const auto &[name, value] : method.scalars)
      if (name == "contact_force_disc_y_N")
        force = value;
    EXPECT_NEAR(std::abs(force), load, .02 * load);
  }
} // namespace
