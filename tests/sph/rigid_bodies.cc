// Rigid bodies that the balance of forces moves, among particles: the operator with their unknowns, and motions against those of
// the same bodies that move as given.

#include "../base/keep_largest.h"
#include "method_fixture.h"

#include <stroma/sph/nsph_method.h>
#include <stroma/sph/sph_method.h>
#include <stroma/sph/step_operator.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  /// A block with a rigid core off its middle, whose pivot is off its own; @p drive is what drives it.
  template <int dim>
  std::string
  block(const std::string &drive, const std::string &law = "central", const std::string &of_core = "")
  {
    const bool        flat = dim == 2;
    const std::string low = flat ? "0.3, 0.3" : "0.25, 0.25, 0.25", high = flat ? "0.7, 0.6" : "0.75, 0.75, 0.75";
    const std::string viscous = "  set Viscosity = 0.5\n  set Density = 1\n  set Viscous operator = " +
                                (law == "fluid" ? "morris" : law) + "\n";
    const std::string material = law == "fluid" ? " subsection gel\n  set Law = fluid\n  set Bulk modulus = 100\n" +
                                                    viscous + " end\n" :
                                                  hypoelastic("gel", 1., .3, viscous);
    const std::string pivot    = "  set Pivot = " + std::string(flat ? "0.4, 0.45" : "0.4, 0.45, 0.5") + "\n";
    const auto        held     = clamped({"x-min", "x-max", "y-min"});
    return scene_of(material, box_body("block", flat ? "1, 1" : "1, 1, 1") +
                                box_body("core", high,
                                         "  set Rigid = true\n  set Lower corner = " + low + "\n" + pivot + of_core)) +
           held.substr(0, held.size() - 4) + drive + "subsection NSPH\n set Spacing = " + (flat ? "0.05" : "0.125") +
           "\nend\nsubsection Linear solver\n set Tolerance = 1e-11\nend\n";
  }

  std::string
  given(const std::string &entries)
  {
    return " subsection drive\n  set Where = body core\n" + entries + " end\nend\n";
  }
  std::string
  loaded(const std::string &entries)
  {
    return "end\nsubsection Loads\n subsection push\n  set Where = body core\n" + entries + " end\nend\n";
  }

  /// What a run of a few steps ends with.
  template <int dim>
  struct Steps
  {
    Steps(const std::string &text, const std::vector<std::string> &set, const unsigned int n, const double dt)
      : scene(text, set)
      , method(scene.parameters, scene.scene, steps_of(dt, n), timers)
    {
      method.setup(nullptr);
      for (unsigned int k = 0; k < n; ++k)
        EXPECT_EQ(method.advance(k * dt, (k + 1) * dt, work), StepStatus::ok);
      for (const auto &[name, value] : method.scalars)
        scalars[name] = value;
    }

    ParticleScene<dim>            scene;
    Timers                        timers;
    Open<Sph::NsphMethod<dim>>    method;
    StepWork                      work;
    std::map<std::string, double> scalars;
  };

  /// Whether the own block of @p A, on one rank, does to @p x what A does, @p Ax.
  template <int dim>
  void
  check_own_block(Sph::StepOperator<dim> &A, const Vector &x, const Vector &Ax)
  {
    const auto         &rows = A.own_block();
    std::vector<double> sum(rows.length.size(), 0.);
    std::size_t         k = 0;
    for (std::size_t i = 0; i < rows.length.size(); ++i)
      for (std::size_t end = k + rows.length[i]; k < end; ++k)
        {
          const std::size_t j = rows.column[k];
          sum[i] += rows.value[k] * x.begin()[j];
          if (j != i)
            sum[j] += rows.value[k] * x.begin()[i];
        }
    ASSERT_EQ(sum.size(), x.size());
    double difference = 0.;
    for (std::size_t i = 0; i < sum.size(); ++i)
      keep_largest(difference, std::abs(sum[i] - Ax.begin()[i]));
    EXPECT_LT(difference, 1e-11 * Ax.linfty_norm());
  }

  template <int dim>
  void
  check_operator(const std::string &text, const double jitter, const bool published, const double dt)
  {
    ParticleScene<dim> fixture(text);
    Timers             timers;
    Sph::Settings      settings;
    settings.arrangement.spacing = dim == 2 ? .05 : .125;
    settings.arrangement.jitter  = jitter;
    if (published)
      {
        settings.formulation = Sph::Formulation::published;
        settings.kernel      = Sph::KernelName::cubic_spline;
      }
    Sph::System<dim> system(fixture.scene, settings, Sph::Dynamics::overdamped, 1., timers);
    system.arrange();
    ASSERT_EQ(system.update_geometry(true), StepStatus::ok);
    system.set_step(0., 1.);
    system.bodies->set_resistance(0., 1.);
    Sph::StepOperator<dim> A(system);
    A.set_step(dt);
    const auto filled = [&](const double seed) {
      Vector x = A.new_vector();
      for (unsigned int i = 0; i < system.particles.n_free; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          x.begin()[i * dim + c] = std::sin(seed * (1e3 * system.particles.id[i] + c));
      std::vector<double> q(system.bodies->size());
      for (unsigned int u = 0; u < q.size(); ++u)
        q[u] = 20. * std::cos(seed * (u + 1.));
      A.set_bodies(x, q);
      return x;
    };
    const Vector a = filled(1.), b = filled(2.);
    Vector       Aa(a), Ab(a);
    A.vmult(Aa, a);
    A.vmult(Ab, b);
    EXPECT_NEAR(b * Aa, a * Ab, 1e-12 * Aa.l2_norm() * b.l2_norm());
    EXPECT_GT(a * Aa, 0.);
    EXPECT_GT(b * Ab, 0.);
    if (!fixture.scene.is_fluid() && dealii::Utilities::MPI::n_mpi_processes(fixture.scene.comm) == 1)
      check_own_block(A, a, Aa);
  }
} // namespace

TEST(RigidBodies, MpiTheOperatorWithBodiesIsSymmetricAndPositive)
{
  for (const std::string law : {"central", "morris", "fluid"})
    for (const double dt : {0., 1e3})
      check_operator<2>(block<2>(loaded("  set Total force = 1; 0\n  set Torque = 1\n"), law), .2, false, dt);
  check_operator<2>(block<2>(loaded("  set Total force = 1; 0\n  set Torque = 1\n"), "morris", "  set Drag = 3\n"), 0.,
                    true, 0.);
  check_operator<3>(block<3>(loaded("  set Total force = 1; 0; 0\n  set Torque = 1; 0; 0\n")), .2, false, 10.);
}

/// Force and torque of a body that moves as given are those that move it so: of all schemes, of solids and of fluids.
TEST(RigidBodies, MpiForcesAndVelocitiesAgree)
{
  const std::vector<std::vector<std::string>> schemes = {{"NSPH/Scheme=backward Euler"},
                                                         {"NSPH/Stress update=explicit"},
                                                         {"NSPH/Formulation=published"}};
  for (const std::string law : {"central", "morris", "fluid"})
    for (const auto &scheme : schemes)
      {
        if (law != "morris" && scheme[0] == "NSPH/Formulation=published")
          continue;
        const bool     is_explicit = scheme != schemes[0];
        const double   dt          = is_explicit ? 1e-6 : .1; // reactions have the stress of a step's end
        const Steps<2> as_given(
          block<2>(given("  set Type = velocity\n  set Velocity = 1e-4; -2e-4\n  set Angular velocity = 5e-4\n"), law),
          scheme, 1, dt);
        const auto    &found = as_given.scalars;
        const Steps<2> driven(block<2>(loaded("  set Total force = " + shortest(found.at("core_force_x_N")) + "; " +
                                              shortest(found.at("core_force_y_N")) +
                                              "\n  set Torque = " + shortest(found.at("core_torque_Nm")) + "\n"),
                                       law),
                              scheme, 1, dt);
        for (const std::string name : {"core_displacement_x_m", "core_displacement_y_m", "core_rotation_rad"})
          EXPECT_NEAR(driven.scalars.at(name) / found.at(name), 1., scheme == schemes[0] ? 1e-4 : 3e-4)
            << name << ", " << law << ", " << scheme[0];
      }
}

/// What acts on the body, the particles and the walls adds up to nothing.
TEST(RigidBodies, MpiForcesAddUpToNothing)
{
  const std::string weight = "  set Total force = 1e-4; -2e-4\n  set Torque = 3e-5\n end\n subsection weight\n"
                             "  set Where = all\n  set Force density = 1e-4; 2e-4\n";
  for (const std::string law : {"central", "morris", "fluid"})
    {
      const Steps<2> run(block<2>(loaded(weight), law), {}, 3, .01);
      const auto    &found = run.scalars;
      EXPECT_NEAR(found.at("core_force_x_N"), 1e-4, 1e-9) << law;
      EXPECT_NEAR(found.at("core_force_y_N"), -2e-4, 1e-9) << law;
      EXPECT_NEAR(found.at("core_torque_Nm"), 3e-5, 1e-9) << law;
      for (const auto &[c, acting] : {std::pair<char, double>{'x', 1e-4 * .88 + 1e-4}, {'y', 2e-4 * .88 - 2e-4}})
        {
          double sum = acting;
          for (const std::string side : {"x-min", "x-max", "y-min"})
            sum += found.at("reaction_" + side + "_" + c + "_N");
          EXPECT_NEAR(sum, 0., 1e-9) << law << ", " << c;
        }
    }
}

/// However large the forces around it are, which here are ten thousand times its load.
TEST(RigidBodies, MpiABodyIsInBalanceToASmallPartOfItsLoad)
{
  // The load that comes with the second of a step's stages counts there.
  for (const std::string load : {"1e-11", "1e-11*if(t>0.005,1,0)"})
    for (const std::string preconditioner : {"jacobi", "amg", "cholesky"})
      {
        const std::string loads = "  set Total force = " + load +
                                  "; 0\n end\n subsection weight\n"
                                  "  set Where = all\n  set Force density = 1e-6; 2e-6\n";
        const Steps<2> run(block<2>(loaded(loads)),
                           {"Linear solver/Tolerance=1e-4", "Linear solver/Preconditioner=" + preconditioner}, 1, .01);
        EXPECT_NEAR(run.scalars.at("core_force_x_N"), 1e-11, 1e-14) << load << ", " << preconditioner;
        EXPECT_NEAR(run.scalars.at("core_force_y_N"), 0., 1e-14) << load << ", " << preconditioner;
      }
}

TEST(RigidBodies, MpiABallInABoxIsPushedAndTurned)
{
  const Steps<3> as_given(
    block<3>(given("  set Type = velocity\n  set Velocity = 1e-4; 0; -2e-4\n  set Angular velocity = 0; 5e-4; 1e-4\n")),
    {"NSPH/Scheme=backward Euler"}, 1, .1);
  const auto &found = as_given.scalars;
  std::string force, torque;
  for (const char c : {'x', 'y', 'z'})
    {
      force += (c == 'x' ? "" : "; ") + shortest(found.at(std::string("core_force_") + c + "_N"));
      torque += (c == 'x' ? "" : "; ") + shortest(found.at(std::string("core_torque_") + c + "_Nm"));
    }
  const Steps<3> driven(block<3>(loaded("  set Total force = " + force + "\n  set Torque = " + torque + "\n")),
                        {"NSPH/Scheme=backward Euler"}, 1, .1);
  for (const char c : {'x', 'y', 'z'})
    for (const std::string &name :
         {std::string("core_displacement_") + c + "_m", std::string("core_rotation_") + c + "_rad"})
      EXPECT_NEAR(driven.scalars.at(name), found.at(name), 1e-8) << name;
}

namespace
{
  std::string
  refusal(const std::string &text)
  {
    try
      {
        Steps<2> run(text, {}, 0, 1.);
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }
} // namespace

TEST(RigidBodies, ABodyInFreeMaterialIsRefusedAndOneWithADragIsNot)
{
  auto text = block<2>(loaded("  set Total force = 1e-4; 0\n"));
  for (const std::string side : {"x-min", "x-max", "y-min"})
    {
      const auto where = text.find(" subsection " + side);
      text.erase(where, text.find(" end\n", where) + 5 - where);
    }
  EXPECT_NE(refusal(text).find("nothing holds rigid body 'core', which the balance of forces moves"), std::string::npos)
    << refusal(text);
  text.replace(text.find("  set Pivot"), 0, "  set Drag = 2\n");
  const Steps<2> run(text, {"Linear solver/Preconditioner=jacobi", "NSPH/Scheme=backward Euler"}, 2, .1);
  EXPECT_NEAR(run.scalars.at("core_displacement_x_m"), .2 * 1e-4 / 2., 1e-9); // the material goes with it
}

namespace
{
  /// A layer of gel between a held side and a rigid plate, which repeats along x.
  std::string
  plate(const std::string &gel, const std::string &of_plate)
  {
    return scene_of(hypoelastic("gel", 1., 0., "  set Viscous operator = morris\n" + gel),
                    box_body("layer", "0.6, 0.9") +
                      box_body("plate", "0.6, 1.5", "  set Rigid = true\n  set Lower corner = 0, 0.9\n" + of_plate)) +
           "subsection Periodic\n set Directions = x\nend\n"
           "subsection Supports\n subsection floor\n  set Where = side y-min\n  set Type = clamp\n end\n"
           " subsection guide\n  set Where = body plate\n  set Displacement = 0; free\n end\nend\n"
           "subsection Loads\n subsection push\n  set Where = body plate\n  set Total force = 0; 4e-4\n end\nend\n"
           "subsection NSPH\n set Spacing = 0.1\nend\nsubsection SPH\n set Spacing = 0.1\nend\n"
           "subsection Linear solver\n set Tolerance = 1e-10\nend\n";
  }

  /// Displacement of the plate at each of @p n steps of @p dt.
  template <typename Method, typename Time>
  std::vector<double>
  path(const std::string &text, const Time &time, const unsigned int n, const double dt)
  {
    ParticleScene<2> scene(text);
    Timers           timers;
    Open<Method>     method(scene.parameters, scene.scene, time, timers);
    StepWork         work;
    method.setup(nullptr);
    std::vector<double> u;
    for (unsigned int k = 0; k < n; ++k)
      {
        EXPECT_EQ(method.advance(k * dt, (k + 1) * dt, work), StepStatus::ok);
        u.push_back(method.system->poses.back().translation[1]);
      }
    return u;
  }
} // namespace

/// u = F/k (1 - exp(-k t/c)), k = E A/L and c = mu A/L: by SDIRK 2.
TEST(RigidBodies, MpiAPlateOnAKelvinVoigtLayerCreeps)
{
  const double k = .6 / .9, c = .5 * .6 / .9, dt = .1;
  const auto   u = path<Sph::NsphMethod<2>>(plate("  set Viscosity = 0.5\n", ""), steps_of(dt, 10), 10, dt);
  for (unsigned int s = 0; s < u.size(); ++s)
    EXPECT_NEAR(u[s], 4e-4 / k * (1. - std::exp(-k * (s + 1) * dt / c)), 5e-3 * 4e-4 / k) << s;
}

/// m u'' + k u = F: u = F/k (1 - cos(w t)), w^2 = k/(m + a third of the layer's mass).
TEST(RigidBodies, MpiAPlateOnALayerOscillates)
{
  const double k = .6 / .9, m = .2, w = std::sqrt(k / (m + .9 * .6 * .01 / 3.)), period = 2. * dealii::numbers::PI / w;
  const auto u = path<Sph::SphMethod<2>>(plate("  set Viscosity = 1e-6\n  set Density = 0.01\n", "  set Mass = 0.2\n"),
                                         2. * period, 16, period / 8.);
  for (unsigned int s = 0; s < u.size(); ++s)
    EXPECT_NEAR(u[s], 4e-4 / k * (1. - std::cos(w * (s + 1) * period / 8.)), 4e-2 * 4e-4 / k) << s;
}

/// Beside material that it does not touch: x = F/m t^2/2, and with a drag v = F/c (1 - exp(-c t/m)).
TEST(RigidBodies, AFreeBodyFalls)
{
  for (const double drag : {0., .5})
    {
      auto text = plate("  set Viscosity = 1\n  set Density = 1\n",
                        "  set Density = 2\n  set Drag = " + shortest(drag) + "\n");
      text.replace(text.find("0, 0.9"), 6, "0, 3.9");
      text.replace(text.find("0.6, 1.5"), 8, "0.6, 4.5");
      const double m = 2. * .6 * .6, F = 4e-4;
      const auto   x = path<Sph::SphMethod<2>>(text, 2., 4, .5);
      for (unsigned int s = 0; s < x.size(); ++s)
        {
          const double t     = (s + 1) * .5;
          const double exact = drag == 0. ? .5 * F / m * t * t :
                                            F / drag * (t - m / drag * (1. - std::exp(-drag * t / m)));
          EXPECT_NEAR(x[s], exact, 2e-2 * exact) << drag << ", " << t;
        }
    }
}

/// Without inertia what touches nothing goes as far in a step as it may, or with F/c.
TEST(RigidBodies, WithoutInertiaABodyComesNearerStepByStep)
{
  for (const std::string resistance : {"Largest approach = 0.01", "Drag = 0.01"})
    {
      auto text = plate("  set Viscosity = 1\n", "  set " + resistance + "\n");
      text.replace(text.find("0, 0.9"), 6, "0, 3.9");
      text.replace(text.find("0.6, 1.5"), 8, "0.6, 4.5");
      const auto x = path<Sph::NsphMethod<2>>(text, steps_of(.1, 4), 4, .1);
      for (unsigned int s = 0; s < x.size(); ++s)
        EXPECT_NEAR(x[s], (s + 1) * (resistance[0] == 'L' ? .01 : .1 * 4e-4 / .01), 1e-12) << resistance;
    }
}
