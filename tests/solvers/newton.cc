#include "../base/keep_largest.h"
#include "spring_chain.h"

#include <stroma/solvers/newton.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace Stroma;
using namespace Stroma::Solvers;

namespace
{
  constexpr unsigned int n = 20; // springs

  struct Problem
  {
    explicit Problem(const unsigned int n_springs = n, const double foundation = 0.)
      : chain(n_springs, foundation)
      , K(chain.matrix())
      , u(chain.vector())
      , linear({Preconditioner::jacobi, 1e-12, 1000})
    {
      settings.displacement_tolerance = 1e-9;
      settings.energy_tolerance       = 1e-16;
    }

    NewtonResult
    solve()
    {
      NewtonScale scale;
      return solve(scale);
    }

    NewtonResult
    solve(NewtonScale &scale)
    {
      const Newton newton(settings, [&](unsigned int, const double r, const double d, double, const unsigned int its) {
        residuals.push_back(r);
        ratios.push_back(d);
        linear_iterations.push_back(its);
      });
      return newton.solve(chain, linear, K, u, scale);
    }

    /// Largest deviation from springs that all carry @p force.
    double
    error(const double force) const
    {
      double place = 0., largest = 0.;
      for (unsigned int i = 1; i <= n; ++i)
        {
          place += SpringChain::stretch(force, i % 2 == 1 ? 1. : 2.) - 1.;
          keep_largest(largest, std::abs(chain.value(u, i) - place));
        }
      return largest;
    }

    SpringChain               chain;
    Matrix                    K;
    Vector                    u;
    LinearSolver              linear;
    NewtonSettings            settings;
    std::vector<double>       residuals, ratios;
    std::vector<unsigned int> linear_iterations;
  };

  /// Displacement of the end when all springs carry @p force.
  double
  end_displacement(const double force)
  {
    return .5 * n * (SpringChain::stretch(force, 1.) + SpringChain::stretch(force, 2.) - 2.);
  }
} // namespace

TEST(MpiNewton, MovesTheEndAllTheWayAndConvergesQuadratically)
{
  Problem p;
  p.settings.inexact = false;
  p.chain.move_end(end_displacement(.8));
  const NewtonResult result = p.solve();
  EXPECT_EQ(result.status, StepStatus::ok);
  EXPECT_LT(p.error(.8), 1e-12);
  EXPECT_DOUBLE_EQ(p.chain.value(p.u, n), end_displacement(.8));
  EXPECT_LE(result.iterations, 6);
  EXPECT_EQ(result.iterations, p.residuals.size());
  ASSERT_GE(p.residuals.size(), 4);
  const double first = p.residuals[0], second = p.residuals[1], third = p.residuals[2];
  EXPECT_LT(first, .5);
  EXPECT_NEAR(std::log(third / second) / std::log(second / first), 2., .4);
}

TEST(MpiNewton, InexactSolvesFindTheSameWithLessWork)
{
  Problem exact(200, 1.), inexact(200, 1.); // so long that conjugate gradients do not end by themselves
  exact.settings.inexact = false;
  exact.chain.move_end(3.);
  inexact.chain.move_end(3.);
  const NewtonResult a = exact.solve(), b = inexact.solve();
  EXPECT_EQ(a.status, StepStatus::ok);
  EXPECT_EQ(b.status, StepStatus::ok);
  inexact.u -= exact.u;
  EXPECT_LT(inexact.u.l2_norm(), 1e-8 * exact.u.l2_norm());
  EXPECT_LE(b.linear_iterations, .7 * a.linear_iterations);
  EXPECT_LE(b.iterations, a.iterations + 2);
}

TEST(Newton, CountsItsWork)
{
  Problem p;
  p.chain.move_end(.4);
  const NewtonResult result = p.solve();
  EXPECT_EQ(result.tangent_assemblies, result.iterations);
  EXPECT_EQ(result.residual_evaluations, result.iterations + 1); // no step was halved
  EXPECT_EQ(result.linear_iterations, p.linear.total_iterations());
  unsigned int sum = 0;
  for (const unsigned int its : p.linear_iterations)
    sum += its;
  EXPECT_EQ(result.linear_iterations, sum);
}

TEST(Newton, KeepsTheTangentOfAnAllButLinearProblem)
{
  for (const double force : {1e-5, .5})
    {
      Problem p;
      p.chain.move_end(end_displacement(force));
      const NewtonResult result = p.solve();
      EXPECT_EQ(result.status, StepStatus::ok);
      EXPECT_LT(p.error(force), 1e-10);
      if (force < 1e-3)
        EXPECT_EQ(result.tangent_assemblies, 1);
      else
        EXPECT_GE(result.tangent_assemblies, 3);
      EXPECT_GT(result.iterations, 1);
    }
}

/// A chain that no step of a kept tangent serves: it turns inside out after the first one until the tangent is made anew.
class FickleChain : public SpringChain
{
public:
  using SpringChain::SpringChain;

  StepStatus
  residual(Vector &r, const Vector &u) override
  {
    ++n_residuals;
    return n_tangents == 1 && n_residuals > 2 ? StepStatus::inverted_point : SpringChain::residual(r, u);
  }
  StepStatus
  tangent(Matrix &K, Vector &r, const Vector &u) override
  {
    ++n_tangents;
    return SpringChain::tangent(K, r, u);
  }

  unsigned int n_residuals = 0, n_tangents = 0;
};

TEST(Newton, ATangentThatServesNoLongerIsMadeAnew)
{
  FickleChain    chain(n);
  Matrix         K = chain.matrix();
  Vector         u = chain.vector();
  LinearSolver   linear({Preconditioner::jacobi, 1e-12, 1000});
  NewtonSettings settings;
  settings.displacement_tolerance = 1e-9;
  settings.energy_tolerance       = 1e-16;
  chain.move_end(end_displacement(1e-5));
  const NewtonResult result = Newton(settings).solve(chain, linear, K, u);
  EXPECT_EQ(result.status, StepStatus::ok);
  EXPECT_GE(chain.n_tangents, 2);
  EXPECT_NEAR(chain.value(u, n), end_displacement(1e-5), 1e-15);
}

TEST(Newton, StopsAtTheTolerancesOfEquationNine)
{
  Problem loose, tight;
  for (Problem *const p : {&loose, &tight})
    {
      p->settings.inexact = false;
      p->chain.move_end(end_displacement(.8));
    }
  loose.settings.displacement_tolerance = 1e-1;
  loose.settings.energy_tolerance       = 1e-1;
  const NewtonResult few = loose.solve(), many = tight.solve();
  EXPECT_EQ(few.status, StepStatus::ok);
  EXPECT_EQ(few.iterations, 2);
  EXPECT_LT(loose.ratios.back(), 1e-1);
  EXPECT_GT(many.iterations, few.iterations);
}

TEST(Newton, SolvesThatShareAScaleAreMeasuredAgainstTheLargestIncrementOfAll)
{
  Problem     alone, shared;
  NewtonScale scale;
  for (Problem *const p : {&alone, &shared})
    {
      p->settings.inexact = false;
      p->chain.move_end(2.);
    }
  ASSERT_EQ(alone.solve().status, StepStatus::ok);
  ASSERT_EQ(shared.solve(scale).status, StepStatus::ok);
  const double largest = scale.largest_increment;
  for (Problem *const p : {&alone, &shared})
    p->chain.move_end(2. + 1e-4);
  scale.tolerance_factor = 1e5;
  EXPECT_EQ(shared.solve(scale).iterations, 1);
  EXPECT_GT(alone.solve().iterations, 1);
  EXPECT_EQ(scale.largest_increment, largest);
  EXPECT_LT(shared.ratios.back(), 1e-4);
}

TEST(Newton, LeavesTheSystemAtTheSolution)
{
  Problem p;
  p.chain.move_end(3.);
  ASSERT_EQ(p.solve().status, StepStatus::ok);
  Vector difference(p.u);
  difference -= p.chain.last_u;
  EXPECT_EQ(difference.l2_norm(), 0.);
}

TEST(Newton, APerfectGuessTakesNoIteration)
{
  Problem p;
  p.settings.displacement_tolerance = 1e-15; // so that the balance of forces decides
  p.chain.move_end(2.);
  ASSERT_EQ(p.solve().status, StepStatus::ok);
  const Vector       solution(p.u);
  const NewtonResult again = p.solve();
  EXPECT_EQ(again.status, StepStatus::ok);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(again.residual_evaluations, 1);
  Vector difference(p.u);
  difference -= solution;
  EXPECT_EQ(difference.l2_norm(), 0.);
}

TEST(Newton, TolerancesBelowRoundOffAreToldAndCostNoIteration)
{
  Problem usual, tight;
  tight.settings.displacement_tolerance = 1e-17;
  tight.settings.energy_tolerance       = 1e-34;
  usual.chain.move_end(2.);
  tight.chain.move_end(2.);
  const NewtonResult a = usual.solve(), b = tight.solve();
  EXPECT_EQ(b.status, StepStatus::ok);
  EXPECT_FALSE(a.below_round_off);
  EXPECT_TRUE(b.below_round_off);
  EXPECT_LE(b.iterations, a.iterations + 1);
  EXPECT_FALSE(tight.solve().below_round_off); // nothing to do, so nothing was asked
}

TEST(Newton, AJumpFromEquilibriumIsNotAPerfectGuess)
{
  Problem p;
  p.chain.move_end(2.);
  ASSERT_EQ(p.solve().status, StepStatus::ok);
  p.chain.move_end(4.);
  const NewtonResult result = p.solve();
  EXPECT_EQ(result.status, StepStatus::ok);
  EXPECT_GE(result.iterations, 2);
  EXPECT_DOUBLE_EQ(p.chain.value(p.u, n), 4.);
}

TEST(MpiNewton, HalvesAStepThatTurnsPointsInsideOut)
{
  Problem p;
  p.chain.pull_end(-6.); // the first increment would stretch the soft springs by -1, the solution by .39
  const NewtonResult result = p.solve();
  EXPECT_EQ(result.status, StepStatus::ok);
  EXPECT_GE(result.residual_evaluations, result.iterations + 3);
  EXPECT_LT(p.error(-6.), 1e-7);
}

TEST(Newton, HalvesAJumpThatTurnsPointsInsideOutAndStillArrives)
{
  Problem p;
  p.chain.move_end(end_displacement(-20.));
  for (unsigned int i = 0; i < n; ++i)
    p.u[i] = .05 * i; // against the jump: the last spring's stretch would pass through zero
  p.u[n] = .05 * n;
  p.u.compress(dealii::VectorOperation::insert);
  const NewtonResult result = p.solve();
  EXPECT_EQ(result.status, StepStatus::ok);
  EXPECT_DOUBLE_EQ(p.chain.value(p.u, n), end_displacement(-20.));
  EXPECT_LT(p.error(-20.), 1e-7);
}

TEST(MpiNewton, FailureLeavesTheGuess)
{
  Problem p;
  p.u                       = .01;
  p.settings.max_iterations = 2;
  p.chain.move_end(end_displacement(3.));
  const NewtonResult result = p.solve();
  EXPECT_EQ(result.status, StepStatus::diverged);
  EXPECT_EQ(result.iterations, 2);
  EXPECT_EQ(p.u.linfty_norm(), .01);
  EXPECT_DOUBLE_EQ(p.u.mean_value(), .01);
}

TEST(Newton, ReportsAnInvertedGuess)
{
  Problem p;
  p.u[5] = 2.;
  p.u.compress(dealii::VectorOperation::insert);
  const NewtonResult result = p.solve();
  EXPECT_EQ(result.status, StepStatus::inverted_point);
  EXPECT_EQ(result.residual_evaluations, 1);
  EXPECT_EQ(result.tangent_assemblies, 0);
}

TEST(Newton, ReportsAFailedLinearSolve)
{
  Problem p;
  p.linear = LinearSolver({Preconditioner::jacobi, 1e-12, 2});
  p.chain.pull_end(1.);
  EXPECT_EQ(p.solve().status, StepStatus::linear_failed);
  EXPECT_EQ(p.u.linfty_norm(), 0.);
}

TEST(Newton, ReportsWhatIsNotFinite)
{
  Problem p;
  p.chain.pull_end(std::numeric_limits<double>::infinity());
  EXPECT_EQ(p.solve().status, StepStatus::not_finite);
}
