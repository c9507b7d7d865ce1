// The operators of the particle methods, each alone.

#include "scene_fixture.h"

#include <stroma/solvers/linear_solver.h>
#include <stroma/sph/step_operator.h>

#include <gtest/gtest.h>

using namespace Stroma;
using dealii::Tensor;

namespace
{
  /// Numbers that depend on id and component alone, in [-1, 1].
  double
  noise(const std::uint64_t id, const unsigned int c, const unsigned int seed = 0)
  {
    std::uint64_t x = id * 7919 + c * 104729 + seed * 1299709 + 12345;
    x               = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x               = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return 2. * ((x ^ (x >> 31)) >> 11) * 0x1.0p-53 - 1.;
  }

  std::string
  gel(const std::string &viscous_operator, const std::string &bodies, const std::string &more)
  {
    return "subsection Materials\n subsection gel\n  set Law = linear elastic\n  set Young's modulus = 2.5\n"
           "  set Poisson's ratio = .45\n  set Viscosity = 100\n  set Density = 1000\n  set Viscous operator = " +
           viscous_operator + "\n end\nend\nsubsection Bodies\n" + bodies + "end\n" + more;
  }

  const std::string square   = " subsection block\n  set Shape = box\n  set Upper corner = 1, 1\n end\n";
  const std::string cube     = " subsection block\n  set Shape = box\n  set Upper corner = 1, 1, 1\n end\n";
  const std::string periodic = "subsection Periodic\n set Directions = x, y\nend\n";

  template <int dim>
  struct Bed
  {
    Bed(const std::string &text, const double spacing, const double jitter, const bool published = false)
      : fixture(text)
    {
      Sph::Settings settings;
      settings.arrangement.spacing = spacing;
      settings.arrangement.jitter  = jitter;
      if (published)
        {
          settings.formulation = Sph::Formulation::published;
          settings.kernel      = Sph::KernelName::cubic_spline;
        }
      system = std::make_unique<Sph::System<dim>>(fixture.scene, settings, Sph::Dynamics::overdamped, 1., timers);
      system->arrange();
      EXPECT_EQ(system->update_geometry(true), StepStatus::ok);
      system->set_step(0., 1.);
    }

    Vector
    random(Sph::StepOperator<dim> &A, const unsigned int seed) const
    {
      Vector x = A.new_vector();
      for (unsigned int i = 0; i < system->particles.n_free; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          x.begin()[i * dim + c] = noise(system->particles.id[i], c, seed);
      return x;
    }

    ParticleScene<dim>                fixture;
    Timers                            timers;
    std::unique_ptr<Sph::System<dim>> system;
  };

  template <int dim>
  void
  check_symmetry(const std::string &text, const double spacing, const double jitter, const bool published, const double dt)
  {
    const Bed<dim>         bed(text, spacing, jitter, published);
    Sph::StepOperator<dim> A(*bed.system);
    A.set_step(dt);
    const Vector a = bed.random(A, 1), b = bed.random(A, 2);
    Vector       Aa(a), Ab(a);
    A.vmult(Aa, a);
    A.vmult(Ab, b);
    EXPECT_NEAR(b * Aa, a * Ab, 1e-13 * Aa.l2_norm() * b.l2_norm());
    EXPECT_GT(a * Aa, 0.);
    EXPECT_GT(b * Ab, 0.);
  }
} // namespace

TEST(Operators, MpiSymmetricPositive)
{
  const std::string held = clamped({ "x-min", "y-max" });
  for (const std::string form : { "morris", "central" })
    for (const double jitter : { 0., .3 })
      for (const double dt : { 0., 10., 1e4 })
        check_symmetry<2>(gel(form, square, held), .1, jitter, false, dt);
  check_symmetry<2>(gel("morris", square, held), .1, .2, true, 0.);
  check_symmetry<3>(gel("central", cube, held), .2, .3, false, 10.);
}

TEST(Operators, MpiMomentumIsConserved)
{
  for (const std::string form : { "morris", "central" })
    for (const bool published : { false, true })
      {
        const Bed<2> bed(gel(form, square, periodic), .1, .3, published);
        auto        &system = *bed.system;
        auto        &p      = system.particles;
        for (unsigned int i = 0; i < p.n_owned; ++i)
          {
            for (unsigned int c = 0; c < 3; ++c)
              p.S[i].access_raw_entry(c) = noise(p.id[i], c);
            p.J[i] = 1. + .01 * noise(p.id[i], 3);
            for (unsigned int c = 0; c < 2; ++c)
              p.v[i][c] = noise(p.id[i], 4 + c);
          }
        system.neighbours->update_ghosts(p.S);
        system.neighbours->update_ghosts(p.J);
        system.neighbours->update_ghosts(p.v);
        Sph::System<2>::Velocities f;
        system.state_forces(f, 1.);
        system.friction->add_force(f, p.v, p.n_free);
        system.elasticity->add_stiffness_force(f, p.v);
        Tensor<1, 2> sum;
        double       size = 0.;
        for (const auto &f_i : f)
          {
            sum += f_i;
            size += f_i.norm();
          }
        EXPECT_LT(dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD).norm(), 1e-13 * dealii::Utilities::MPI::sum(size, MPI_COMM_WORLD));
      }
}

TEST(Operators, MpiUniformStressLeavesNoForceOnDisorderedParticles)
{
  // Published area vectors fail this patch test; closed ones pass up to the tolerance of the closing.
  double force[2];
  for (const bool published : { false, true })
    {
      const Bed<2> bed(gel("morris", square, periodic), .05, .3, published);
      auto        &p = bed.system->particles;
      for (unsigned int i = 0; i < p.size(); ++i)
        p.S[i][0][1] = 1.;
      Sph::System<2>::Velocities f;
      bed.system->state_forces(f, 1.);
      double sum = 0.;
      for (const auto &f_i : f)
        sum += f_i.norm_square();
      sum = dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
      force[published] = std::sqrt(sum / bed.system->n_free) / .05; // over stress times spacing
    }
  EXPECT_LT(force[0], 2e-2);
  EXPECT_GT(force[1], 1e-1);
}

TEST(Operators, MpiGradientOfALinearVelocityIsExact)
{
  const Bed<2>                  bed(gel("morris", square, clamped({ "x-min" })), .05, .3);
  auto                         &p = bed.system->particles;
  Sph::System<2>::Velocities    v(p.size());
  const Tensor<2, 2>            slope{ { { .3, -.7 }, { .2, .4 } } };
  for (unsigned int i = 0; i < p.size(); ++i)
    v[i] = slope * Tensor<1, 2>(p.x[i]);
  std::vector<Tensor<2, 2>> L(bed.system->pairs.n_rows());
  bed.system->elasticity->velocity_gradient(L, v);
  double worst = 0.;
  for (unsigned int i = 0; i < p.n_free; ++i)
    if (p.X[i][0] > .2) // beyond the reach of the wall
      worst = std::max(worst, (L[i] - slope).norm());
  EXPECT_LT(worst, 2e-2);
}

TEST(Operators, MpiRigidRotationOfAFreeDisk)
{
  // Dissipation of v = Omega x r over mu Omega^2 A: 0 of central forces, about 2 of the morris form (its stress mu grad v).
  const std::string disk = " subsection disk\n  set Shape = ball\n  set Centre = 0, 0\n  set Radius = 1\n end\n";
  for (const std::string form : { "morris", "central" })
    {
      const Bed<2>               bed(gel(form, disk, ""), .05, 0.);
      auto                      &p = bed.system->particles;
      Sph::System<2>::Velocities v(p.size()), f(p.n_free);
      for (unsigned int i = 0; i < p.size(); ++i)
        {
          v[i][0] = -p.x[i][1];
          v[i][1] = p.x[i][0];
        }
      bed.system->friction->add_force(f, v, p.n_free);
      double power = 0., largest = 0.;
      for (unsigned int i = 0; i < p.n_free; ++i)
        {
          power -= f[i] * v[i];
          largest = std::max(largest, f[i].norm());
        }
      power = dealii::Utilities::MPI::sum(power, MPI_COMM_WORLD) / (100. * dealii::numbers::PI);
      if (form == "central")
        {
          EXPECT_LT(largest, 1e-12);
          EXPECT_NEAR(power, 0., 1e-13);
        }
      else
        EXPECT_NEAR(power, 2., .06);
    }
}

namespace
{
  /// Growth of the velocity over the last of @p n explicit steps of length @p dt from random stresses in a periodic box.
  double
  growth(const std::string &form, const double dt, const double jitter, const bool published, const unsigned int n)
  {
    const Bed<2> bed(gel(form, square, periodic), .05, jitter, published);
    auto        &system = *bed.system;
    auto        &p      = system.particles;
    // A compression wave, the mode that the limit is of, of every length: random volumes, tiny.
    for (unsigned int i = 0; i < p.n_owned; ++i)
      p.J[i] = 1. + 1e-9 * noise(p.id[i], 0);
    system.neighbours->update_ghosts(p.J);
    Sph::StepOperator<2> A(system);
    Solvers::LinearSolverSettings settings;
    settings.preconditioner = Solvers::Preconditioner::jacobi;
    Solvers::LinearSolver solver(settings);
    double                before = 0., now = 0.;
    for (unsigned int step = 0; step < n; ++step)
      {
        A.set_step(0.);
        Sph::System<2>::Velocities f;
        system.state_forces(f, 1.);
        Vector b = A.new_vector(), x(b);
        for (unsigned int i = 0; i < p.n_free; ++i)
          for (unsigned int c = 0; c < 2; ++c)
            b.begin()[i * 2 + c] = f[i][c];
        double mean[2] = { 0., 0. };
        for (unsigned int i = 0; i < p.n_free; ++i)
          for (unsigned int c = 0; c < 2; ++c)
            mean[c] += f[i][c] / p.n_free;
        for (unsigned int i = 0; i < p.n_free; ++i)
          for (unsigned int c = 0; c < 2; ++c)
            b.begin()[i * 2 + c] -= mean[c];
        EXPECT_TRUE(solver.solve(A, x, b, 1e-6 * b.l2_norm()).converged);
        auto v = p.v;
        for (unsigned int i = 0; i < p.n_free; ++i)
          for (unsigned int c = 0; c < 2; ++c)
            v[i][c] = x.begin()[i * 2 + c];
        system.neighbours->update_ghosts(v);
        before = now;
        now    = x.l2_norm();
        system.set_gradient(v);
        system.commit(v, dt);
      }
    return now / before;
  }
} // namespace

TEST(Operators, ExplicitStressesAreStableUpToTheirLimit)
{
  const double E = 2.5, nu = .45, M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  for (const std::string form : { "morris", "central" })
    {
      const double limit = 2. * (form == "central" ? 3. : 1.) * 100. / M;
      EXPECT_LT(growth(form, .98 * limit, 0., false, 150), 1.);
      EXPECT_GT(growth(form, 1.02 * limit, 0., false, 150), 1.);
    }
}
