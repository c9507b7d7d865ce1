#include "elasticity.h"

#include <stroma/solvers/linear_solver.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Map.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace Stroma;
using namespace Stroma::Solvers;

namespace
{
  LinearSolver
  make_solver(const Elasticity &problem, const Preconditioner preconditioner)
  {
    LinearSolver solver({preconditioner, 1e-10, 2000});
    solver.set_near_null_space(problem.rigid_body_modes());
    return solver;
  }

  /// A cube of n^3 cells with the hierarchies of its solver.
  struct Cube
  {
    explicit Cube(const unsigned int n)
      : problem({n, n, n}, dealii::Tensor<1, 3>({1., 1., 1.}))
      , solver(make_solver(problem, Preconditioner::amg))
      , x(problem.vector())
    {
      problem.assemble();
    }

    LinearResult
    solve(const double tolerance)
    {
      return solver.solve(problem.matrix, x, problem.rhs, tolerance);
    }

    Elasticity   problem;
    LinearSolver solver;
    Vector       x;
  };

  constexpr double reference_energy = 30.905967714066; // found on one rank

  /// Adds a skew part to a symmetric matrix: what is above the diagonal grows, what is below shrinks by @p part.
  void
  skew(Matrix &matrix, const double part)
  {
    const Epetra_CrsMatrix &rows = matrix.trilinos_matrix();
    for (int i = 0; i < rows.NumMyRows(); ++i)
      {
        int     n, *columns;
        double *values;
        rows.ExtractMyRowView(i, n, values, columns);
        for (int k = 0; k < n; ++k)
          if (const auto difference = rows.ColMap().GID64(columns[k]) - rows.RowMap().GID64(i); difference != 0)
            values[k] *= difference > 0 ? 1. + part : 1. - part;
      }
  }

  double
  relative_residual(const Elasticity &problem, const Vector &x)
  {
    Vector r(problem.rhs);
    return problem.matrix.residual(r, x, problem.rhs) / problem.rhs.l2_norm();
  }
} // namespace

TEST(LinearSolver, MultigridIterationsDoNotGrowWithTheGrid)
{
  unsigned int iterations[2];
  for (const unsigned int k : {0, 1})
    {
      Cube               cube(8u << k);
      const LinearResult result = cube.solve(1e-8);
      EXPECT_TRUE(result.converged);
      EXPECT_LT(relative_residual(cube.problem, cube.x), 1e-8);
      iterations[k] = result.iterations;
    }
  EXPECT_LE(iterations[1], 30);
  EXPECT_LE(iterations[1], 1.5 * iterations[0]);
}

/// Of powers of 2, so that rounding is the same.
TEST(LinearSolver, SolutionsDoNotDependOnUnits)
{
  for (const unsigned int edge : {4, 16}) // alone, and as the finest of several grids
    {
      Elasticity problem({edge, edge, edge}, dealii::Tensor<1, 3>({1., 1., 1.}));
      problem.assemble();
      std::vector<Vector> solutions;
      for (const double unit : {1., std::ldexp(1., -60), std::ldexp(1., 60)})
        {
          problem.matrix *= unit;
          LinearSolver solver = make_solver(problem, Preconditioner::amg);
          Vector       x      = problem.vector();
          EXPECT_TRUE(solver.solve(problem.matrix, x, problem.rhs, 1e-6).converged) << unit;
          x *= unit;
          solutions.push_back(x);
          problem.matrix /= unit;
        }
      for (const unsigned int other : {1, 2})
        {
          solutions[other] -= solutions[0];
          EXPECT_EQ(solutions[other].l2_norm(), 0.) << edge;
        }
    }
}

TEST(MpiLinearSolver, BothPreconditionersFindTheSameEnergyOnAnyNumberOfRanks)
{
  Elasticity problem({8, 8, 4}, dealii::Tensor<1, 3>({1., 1., .5}));
  problem.assemble();
  for (const Preconditioner preconditioner : {Preconditioner::jacobi, Preconditioner::amg})
    {
      LinearSolver solver = make_solver(problem, preconditioner);
      Vector       x      = problem.vector();
      ASSERT_TRUE(solver.solve(problem.matrix, x, problem.rhs, 1e-11).converged);
      EXPECT_NEAR(x * problem.rhs, reference_energy, 1e-9 * reference_energy);
    }
}

/// One iteration gives M^-1 b up to a factor, which cancels in the cyclic product over three right-hand sides: it is 1 if
/// M^-1 is symmetric.
TEST(MpiLinearSolver, PreconditionersAreSymmetricAcrossRanks)
{
  Elasticity problem({12, 12, 12}, dealii::Tensor<1, 3>({1., 1., 1.}));
  problem.assemble();
  for (const Preconditioner preconditioner : {Preconditioner::jacobi, Preconditioner::amg})
    {
      LinearSolver solver({preconditioner, 1e-10, 1});
      const auto   modes = problem.rigid_body_modes();
      solver.set_near_null_space(modes);
      std::vector<Vector> b, z;
      for (const unsigned int k : {1, 2, 3})
        {
          Vector force = problem.vector();
          for (const auto i : force.locally_owned_elements())
            force[i] = modes[0][i] + modes[1][i] + modes[2][i] != 0. ? std::sin(1. + k * i) : 0.; // on free unknowns
          force.compress(dealii::VectorOperation::insert);
          b.push_back(force);
          Vector x = problem.vector();
          solver.forget(); // or it would go on with a new set-up after one iteration with the old
          solver.solve(problem.matrix, x, force, 1e-10);
          z.push_back(x);
        }
      const double there = (b[1] * z[0]) * (b[2] * z[1]) * (b[0] * z[2]);
      const double back  = (b[0] * z[1]) * (b[1] * z[2]) * (b[2] * z[0]);
      EXPECT_NEAR(there / back, 1., 1e-9);
    }
}

TEST(LinearSolver, PrescribedUnknownsAreExact)
{
  Elasticity problem({4, 4, 4}, dealii::Tensor<1, 3>({1., 1., 1.}));
  problem.assemble();
  for (const Preconditioner preconditioner : {Preconditioner::jacobi, Preconditioner::amg})
    {
      LinearSolver solver = make_solver(problem, preconditioner);
      Vector       x      = problem.vector();
      ASSERT_TRUE(solver.solve(problem.matrix, x, problem.rhs, .1).converged);
      unsigned int moved = 0;
      for (unsigned int i = 0; i < x.size(); ++i)
        moved += std::abs(x[i] - .4) < 1e-15;
      EXPECT_EQ(moved, 25); // nodes of the far face
    }
}

TEST(MpiLinearSolver, ZeroRightHandSideGivesZero)
{
  Cube cube(4);
  cube.x                    = 7.;
  const LinearResult result = cube.solver.solve(cube.problem.matrix, cube.x, cube.problem.vector(), 1e-8);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(cube.x.l2_norm(), 0.);
  EXPECT_EQ(cube.solver.setups(), 0);
}

TEST(MpiLinearSolver, ReportsNoConvergence)
{
  Elasticity problem({8, 8, 4}, dealii::Tensor<1, 3>({1., 1., 1.}));
  problem.assemble();
  LinearSolver       solver({Preconditioner::jacobi, 1e-10, 5});
  Vector             x      = problem.vector();
  const LinearResult result = solver.solve(problem.matrix, x, problem.rhs, 1e-10);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 5);
}

TEST(MpiLinearSolver, ReportsWhatIsNotFinite)
{
  Elasticity problem({4, 4, 4}, dealii::Tensor<1, 3>({1., 1., 1.}));
  problem.assemble();
  Vector b = problem.rhs, x = problem.vector();
  b.add(std::numeric_limits<double>::quiet_NaN());
  for (const Preconditioner preconditioner : {Preconditioner::jacobi, Preconditioner::amg})
    {
      LinearSolver solver = make_solver(problem, preconditioner);
      EXPECT_FALSE(solver.solve(problem.matrix, x, b, 1e-8).converged);
      problem.matrix *= std::numeric_limits<double>::infinity();
      EXPECT_FALSE(solver.solve(problem.matrix, x, problem.rhs, 1e-8).converged);
      problem.assemble();
      EXPECT_TRUE(solver.solve(problem.matrix, x, problem.rhs, 1e-8).converged);
    }
}

TEST(MpiLinearSolver, KeepsTheHierarchyWhileItIsGood)
{
  Cube       cube(8);
  const auto first = cube.solve(1e-6);
  for (const double stiffening : {1.01, 1.02, 1.03})
    {
      cube.problem.assemble(stiffening);
      EXPECT_TRUE(cube.solve(1e-6).converged);
      EXPECT_LT(relative_residual(cube.problem, cube.x), 1e-6);
    }
  EXPECT_EQ(cube.solver.setups(), 1);
  cube.problem.assemble(1e4);
  for (unsigned int i = 0; i < 3; ++i)
    EXPECT_TRUE(cube.solve(1e-6).converged);
  EXPECT_EQ(cube.solver.setups(), 2);
  EXPECT_GT(cube.solver.total_iterations(), 6 * first.iterations);
}

/// Not when it has taken as many iterations as a whole solve and a set-up.
TEST(MpiLinearSolver, GivesUpAnAgedHierarchyAsSoonAsItLags)
{
  Cube       cube(12);
  const auto first = cube.solve(1e-12);
  cube.problem.assemble(1e4);
  const auto both = cube.solve(1e-12);
  cube.solver.forget();
  const auto fresh = cube.solve(1e-12);
  EXPECT_TRUE(both.converged);
  std::cout << "iterations before " << first.iterations << ", with an aged and a new hierarchy " << both.iterations
            << ", with the new one " << fresh.iterations << std::endl;
  EXPECT_LT(both.iterations, fresh.iterations + first.iterations);
}

TEST(LinearSolver, RepeatsToTheLastDigitAfterForgetting)
{
  Elasticity problem({8, 8, 8}, dealii::Tensor<1, 3>({1., 1., 1.}));
  problem.assemble();
  LinearSolver used = make_solver(problem, Preconditioner::amg), fresh = make_solver(problem, Preconditioner::amg);
  Vector       x = problem.vector(), y = problem.vector();
  used.solve(problem.matrix, x, problem.rhs, 1e-6);
  problem.assemble(1.5);
  used.solve(problem.matrix, x, problem.rhs, 1e-6);
  used.forget();
  const auto a = used.solve(problem.matrix, x, problem.rhs, 1e-6);
  const auto b = fresh.solve(problem.matrix, y, problem.rhs, 1e-6);
  EXPECT_EQ(a.iterations, b.iterations);
  x -= y;
  EXPECT_EQ(x.linfty_norm(), 0.);
}

TEST(MpiLinearSolver, SolvesWhatIsNotSymmetricToTheTrueResidual)
{
  Elasticity problem({12, 12, 8}, dealii::Tensor<1, 3>({1., 1., .5}));
  problem.assemble();
  skew(problem.matrix, .4);
  double energy[2];
  for (const Preconditioner preconditioner : {Preconditioner::jacobi, Preconditioner::amg})
    {
      LinearSolver solver = make_solver(problem, preconditioner);
      solver.set_symmetric(false);
      Vector     x      = problem.vector();
      const auto result = solver.solve(problem.matrix, x, problem.rhs, 1e-10);
      ASSERT_TRUE(result.converged);
      EXPECT_LT(relative_residual(problem, x), 1.01e-10);
      energy[preconditioner == Preconditioner::amg] = x * problem.rhs;
    }
  EXPECT_NEAR(energy[0], energy[1], 1e-8 * std::abs(energy[0]));
}

TEST(LinearSolver, GmresGoesOnBeyondItsRestart)
{
  Elasticity problem({16, 16, 8}, dealii::Tensor<1, 3>({1., 1., .5}));
  problem.assemble();
  LinearSolver solver = make_solver(problem, Preconditioner::jacobi);
  solver.set_symmetric(false);
  Vector     x      = problem.vector();
  const auto result = solver.solve(problem.matrix, x, problem.rhs, 1e-6);
  EXPECT_TRUE(result.converged);
  EXPECT_GT(result.iterations, 198);
  EXPECT_LT(relative_residual(problem, x), 1.01e-6);
}

TEST(MpiLinearSolver, GmresReportsNoConvergence)
{
  Elasticity problem({8, 8, 4}, dealii::Tensor<1, 3>({1., 1., 1.}));
  problem.assemble();
  LinearSolver solver({Preconditioner::jacobi, 1e-10, 5});
  solver.set_symmetric(false);
  Vector     x      = problem.vector();
  const auto result = solver.solve(problem.matrix, x, problem.rhs, 1e-10);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 5);
  problem.matrix *= std::numeric_limits<double>::infinity();
  EXPECT_FALSE(solver.solve(problem.matrix, x, problem.rhs, 1e-10).converged);
}

TEST(LinearSolver, ForgetsWhereSymmetryChanges)
{
  Cube cube(4);
  for (const bool symmetric : {true, true, false, false})
    {
      cube.solver.set_symmetric(symmetric);
      EXPECT_TRUE(cube.solve(1e-6).converged);
    }
  EXPECT_EQ(cube.solver.setups(), 2);
}
