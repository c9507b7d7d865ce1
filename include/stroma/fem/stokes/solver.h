#pragma once

#include <stroma/fem/stokes/system.h>
#include <stroma/solvers/linear_solver.h>

#include <memory>

namespace Stroma::Fem
{
  /**
   * Minimal residuals for the symmetric indefinite systems [A B^T; B -C] x = r of Stokes' equations, preconditioned by
   * the block diagonal of multigrid (or Jacobi) on A and symmetric Gauss-Seidel on the pressure mass matrix S; with
   * inertia, a multigrid on L is added to the inverse of S (Cahouet & Chabard 1988). All calls are collective.
   */
  class StokesSolver
  {
  public:
    /// @param m refers to matrices of which the caller takes care
    StokesSolver(const Solvers::LinearSolverSettings &settings, const StokesMatrices &m);
    ~StokesSolver();

    /// Sets up the preconditioner for the present matrices. @param modes see Solvers::LinearSolver. False if it cannot.
    bool set_up(const std::vector<Vector> &modes);

    /// Solves for @p x to the tolerance of the settings, over the right-hand side and in the norm of the preconditioner;
    /// the start is zero. Held unknowns must be zero in @p r. Failure is reported alike on all ranks.
    Solvers::LinearResult solve(StokesFlow &x, const StokesFlow &r) const;

  private:
    struct Operator;
    struct BlockDiagonal;

    Solvers::LinearSolverSettings  settings;
    const StokesMatrices          &m;
    std::unique_ptr<BlockDiagonal> preconditioner;
  };
} // namespace Stroma::Fem
