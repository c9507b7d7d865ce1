// The operators of the particle methods, each alone.

#include "../base/keep_largest.h"
#include "../particles/scene_fixture.h"

#include <stroma/solvers/linear_solver.h>
#include <stroma/sph/rotation.h>
#include <stroma/sph/step_operator.h>

#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

using namespace Stroma;
using dealii::SymmetricTensor;
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
    return scene_of(hypoelastic("gel", 2.5, .45,
                                "  set Viscosity = 100\n  set Density = 1000\n  set Viscous operator = " +
                                  viscous_operator + "\n"),
                    bodies, more);
  }

  const std::string unit_square = box_body("block", "1, 1");
  const std::string unit_cube   = box_body("block", "1, 1, 1");
  const std::string periodic    = "subsection Periodic\n set Directions = x, y\nend\n";

  template <int dim>
  struct Bed
  {
    /// @param n_closings area vectors go on closing from where they were at each update, as from step to step of a run
    Bed(const std::string &text, const double spacing, const double jitter, const bool published = false,
        const unsigned int n_closings = 1)
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
      for (unsigned int k = 0; k < n_closings; ++k)
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
  check_symmetry(const std::string &text, const double spacing, const double jitter, const bool published,
                 const double dt)
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
  const std::string held = clamped({"x-min", "y-max"});
  for (const std::string form : {"morris", "central"})
    for (const double jitter : {0., .3})
      for (const double dt : {0., 10., 1e4})
        check_symmetry<2>(gel(form, unit_square, held), .1, jitter, false, dt);
  check_symmetry<2>(gel("morris", unit_square, held), .1, .2, true, 0.);
  check_symmetry<3>(gel("central", unit_cube, held), .2, .3, false, 10.);
}

TEST(Operators, MpiMomentumIsConserved)
{
  for (const std::string form : {"morris", "central"})
    for (const bool published : {false, true})
      {
        const Bed<2> bed(gel(form, unit_square, periodic), .1, .3, published);
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
        Sph::System<2>::Velocities f, resisting;
        system.state_forces(f, 1.);
        Sph::StepOperator<2> A(system);
        A.set_step(published ? 0. : 10.);
        A.force(resisting, p.v);
        Tensor<1, 2> sum;
        double       size = 0.;
        for (unsigned int i = 0; i < p.n_free; ++i)
          {
            sum += f[i] + resisting[i];
            size += f[i].norm() + resisting[i].norm();
          }
        EXPECT_LT(dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD).norm(),
                  1e-13 * dealii::Utilities::MPI::sum(size, MPI_COMM_WORLD));
      }
}

TEST(Operators, MpiStressesHaveNoTorque)
{
  // Of a block that nothing holds, whatever its stresses are: the gradient is exact for turns, and forces are minus its adjoint.
  const Bed<2> bed(gel("central", unit_square, ""), .1, .1);
  auto        &p = bed.system->particles;
  for (unsigned int i = 0; i < p.n_owned; ++i)
    for (unsigned int c = 0; c < 3; ++c)
      p.S[i].access_raw_entry(c) = noise(p.id[i], c);
  bed.system->neighbours->update_ghosts(p.S);
  Sph::System<2>::Velocities f;
  bed.system->state_forces(f, 1.);
  double sums[2] = {0., 0.};
  for (unsigned int i = 0; i < p.n_free; ++i)
    {
      sums[0] += p.x[i][0] * f[i][1] - p.x[i][1] * f[i][0];
      sums[1] += p.x[i].norm() * f[i].norm();
    }
  dealii::Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
  EXPECT_LT(std::abs(sums[0]), 1e-13 * sums[1]);
}

TEST(Operators, MpiUniformStressLeavesNoForceOnDisorderedParticles)
{
  // Published area vectors fail this patch test; closed ones pass up to the tolerance of the closing. With more disorder
  // than .2 some particles have so few neighbours that they count as free surface.
  double force[2];
  for (const bool published : {false, true})
    {
      const Bed<2> bed(gel("morris", unit_square, periodic), .05, .2, published, 5);
      auto        &p = bed.system->particles;
      for (unsigned int i = 0; i < p.size(); ++i)
        p.S[i][0][1] = 1.;
      Sph::System<2>::Velocities f;
      bed.system->state_forces(f, 1.);
      double sum = 0.;
      for (const auto &f_i : f)
        sum += f_i.norm_square();
      sum              = dealii::Utilities::MPI::sum(sum, MPI_COMM_WORLD);
      force[published] = std::sqrt(sum / bed.system->n_free) / .05; // over stress times spacing
    }
  EXPECT_LT(force[0], 2e-2);
  EXPECT_GT(force[1], 1e-1);
}

TEST(Operators, MpiGradientOfALinearVelocityIsExact)
{
  const Bed<2>               bed(gel("morris", unit_square, clamped({"x-min"})), .05, .3, false, 5);
  auto                      &p = bed.system->particles;
  Sph::System<2>::Velocities v(bed.system->pairs.n_points());
  const Tensor<2, 2>         slope{{{.3, -.7}, {.2, .4}}};
  for (unsigned int i = 0; i < p.size(); ++i)
    v[i] = slope * Tensor<1, 2>(p.x[i]);
  std::vector<Tensor<2, 2>> L(bed.system->pairs.n_rows());
  bed.system->elasticity->velocity_gradient(L, v);
  double sums[2] = {0., 0.};
  for (unsigned int i = 0; i < p.n_free; ++i)
    if (p.X[i][0] > .2) // beyond the reach of the wall
      {
        sums[0] += (L[i] - slope).norm_square();
        sums[1] += 1.;
      }
  dealii::Utilities::MPI::sum(sums, MPI_COMM_WORLD, sums);
  EXPECT_LT(std::sqrt(sums[0] / sums[1]), 2e-2);
}

TEST(Operators, MpiParticlesOnTopOfEachOtherAreReported)
{
  const Bed<2> bed(gel("morris", unit_square, periodic), .1, 0.);
  auto        &p = bed.system->particles;
  // On one rank alone: all must hear of it.
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    p.x[1] = p.x[0];
  EXPECT_EQ(bed.system->update_geometry(), StepStatus::moved_too_far);
}

TEST(Operators, ALonelyParticleDoesNoHarm)
{
  const std::string dot =
    " subsection dot\n  set Shape = ball\n  set Centre = 3.05, .55\n  set Radius = .06\n  set Material = gel\n end\n";
  for (const std::string form : {"morris", "central"})
    {
      const Bed<2> bed(gel(form, unit_square + dot, clamped({"y-min"})), .1, 0.);
      ASSERT_EQ(bed.system->particles.n_free, 101u);
      Sph::StepOperator<2>       A(*bed.system);
      Sph::System<2>::Velocities v(bed.system->pairs.n_points()), f;
      for (unsigned int i = 0; i < v.size(); ++i)
        v[i][0] = noise(i, 0);
      A.set_step(1.);
      A.force(f, v);
      for (const auto &f_i : f)
        EXPECT_TRUE(std::isfinite(f_i.norm()));
    }
}

namespace
{
  /// Power lost by the rotation v = Omega x r of a free disk over mu Omega^2 A, and the largest force over mu Omega.
  std::pair<double, double>
  rotation(const std::string &form, const double spacing, const bool published, const unsigned int n_closings = 1)
  {
    const std::string disk = " subsection disk\n  set Shape = ball\n  set Centre = 0, 0\n  set Radius = 1\n end\n";
    const Bed<2>      bed(gel(form, disk, ""), spacing, 0., published, n_closings);
    auto             &p = bed.system->particles;
    Sph::System<2>::Velocities v(p.size()), f;
    for (unsigned int i = 0; i < p.size(); ++i)
      {
        v[i][0] = -p.x[i][1];
        v[i][1] = p.x[i][0];
      }
    Sph::StepOperator<2> A(*bed.system);
    A.set_step(0.);
    A.force(f, v);
    double power = 0., largest = 0.;
    for (unsigned int i = 0; i < p.n_free; ++i)
      {
        power -= f[i] * v[i];
        keep_largest(largest, f[i].norm());
      }
    return {dealii::Utilities::MPI::sum(power, MPI_COMM_WORLD) / (100. * dealii::numbers::PI),
            dealii::Utilities::MPI::max(largest, MPI_COMM_WORLD) / 100.};
  }
} // namespace

TEST(Operators, MpiRigidRotationOfAFreeDisk)
{
  // Central forces between pairs do not feel it; nor does a velocity gradient, as far as it is exact.
  EXPECT_LT(rotation("central", .05, true).second, 1e-14);
  EXPECT_NEAR(rotation("central", .05, true).first, 0., 1e-14);
  // The error of the gradient, squared: what the ridge of the area vectors leaves, .003 and more at the rim.
  EXPECT_LT(rotation("central", .05, false, 5).first, 1e-4);
  // The morris form has the stress mu grad v, so 2 mu Omega^2 A; particles at the surface lack half their pairs, so a share
  // in proportion to the spacing is missing.
  const double coarse = 2. - rotation("morris", .1, false).first, fine = 2. - rotation("morris", .05, false).first;
  EXPECT_GT(fine, 0.);
  EXPECT_LT(fine, .1);
  EXPECT_NEAR(coarse / fine, 2., .3);
}

namespace
{
  /// Largest growth of K in A(dt) = Gamma + dt K over Gamma, times mu_P/M: explicit stresses are stable up to 2 over it.
  double
  stiffest(const std::string &form, const std::string &more, const double spacing, const double jitter,
           const bool published)
  {
    const Bed<2>                  bed(gel(form, unit_square, more), spacing, jitter, published, jitter > 0. ? 5 : 1);
    auto                         &p = bed.system->particles;
    Sph::StepOperator<2>          A(*bed.system);
    Solvers::LinearSolverSettings settings;
    settings.preconditioner = Solvers::Preconditioner::jacobi;
    Solvers::LinearSolver solver(settings);
    Vector                x     = bed.random(A, 1), Kx(x), Gx(x);
    double                ratio = 0.;
    for (unsigned int k = 0; k < 80; ++k)
      {
        x /= x.l2_norm();
        A.set_step(1.);
        A.vmult(Kx, x);
        A.set_step(0.);
        A.vmult(Gx, x);
        Kx -= Gx;
        ratio = (x * Kx) / (x * Gx);
        if (!bed.system->is_supported())
          for (unsigned int c = 0; c < 2; ++c)
            {
              double mean = 0.;
              for (unsigned int i = 0; i < p.n_free; ++i)
                mean += Kx.begin()[i * 2 + c] / p.n_free;
              for (unsigned int i = 0; i < p.n_free; ++i)
                Kx.begin()[i * 2 + c] -= mean;
            }
        EXPECT_TRUE(solver.solve(A, x, Kx, 1e-5 * Kx.l2_norm()).converged);
      }
    const double E = 2.5, nu = .45, M = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    return ratio * (form == "central" ? 3. : 1.) * 100. / M;
  }
} // namespace

TEST(Operators, MpiStressTurnsWithTheMaterial)
{
  const std::string disk = " subsection disk\n  set Shape = ball\n  set Centre = 0, 0\n  set Radius = 1\n end\n";
  // A quarter turn of a free disk under uniform stress: S -> R S R^T.
  const Bed<2>          bed(gel("central", disk, ""), .1, 0., false, 5);
  auto                 &p  = bed.system->particles;
  const unsigned int    n  = 16;
  const double          dt = dealii::numbers::PI / 2 / n; // a quarter turn at Omega = 1
  SymmetricTensor<2, 2> S;
  S[0][0] = 1.;
  S[0][1] = .3;
  S[1][1] = -.6;
  for (unsigned int i = 0; i < p.size(); ++i)
    p.S[i] = S;
  for (unsigned int k = 0; k < n; ++k)
    {
      Sph::System<2>::Velocities v(p.size());     // the number of ghosts changes
      for (unsigned int i = 0; i < p.size(); ++i) // ghosts: positions as of the last update_geometry()
        v[i] = (std::sin(dt) * Tensor<1, 2>{{-p.x[i][1], p.x[i][0]}} - (1. - std::cos(dt)) * p.x[i]) / dt; // chords
      bed.system->neighbours->update_ghosts(v);
      bed.system->set_gradient(v);
      bed.system->commit(v, dt);
      EXPECT_EQ(bed.system->update_geometry(true), StepStatus::ok);
    }
  const Tensor<2, 2> R{{{0., -1.}, {1., 0.}}};
  const auto         turned = Sph::rotated(S, R);
  double n_inside = 0., off = 0., of_volume = 0.; // squares; gradients are as exact as area vectors are closed
  for (unsigned int i = 0; i < p.n_free; ++i)
    if (p.X[i].norm() < .6)
      {
        n_inside += 1.;
        off += (p.S[i] - turned) * (p.S[i] - turned);
        of_volume += (p.J[i] - 1.) * (p.J[i] - 1.);
      }
  const auto sum = [](const double part) { return dealii::Utilities::MPI::sum(part, MPI_COMM_WORLD); };
  EXPECT_LT(std::sqrt(sum(off) / sum(n_inside)), 1e-2);
  EXPECT_LT(std::sqrt(sum(of_volume) / sum(n_inside)), 1e-3); // a turn along tangents would leave .08
}

TEST(Operators, ExplicitStressesAreStableUpToTheirLimit)
{
  // In a periodic box: beside walls and free surfaces steps must be shorter.
  for (const std::string form : {"morris", "central"})
    {
      EXPECT_NEAR(stiffest(form, periodic, .025, 0., false), 1., .02);
      EXPECT_NEAR(stiffest(form, periodic, .05, .3, false), 1., .1);
    }
  EXPECT_NEAR(stiffest("morris", periodic, .025, 0., true), 1., .02);
}
