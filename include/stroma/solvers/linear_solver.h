#pragma once

#include <stroma/solvers/incomplete_cholesky.h>

#include <deal.II/lac/solver_control.h>
#include <deal.II/lac/trilinos_precondition.h>

#include <memory>
#include <optional>
#include <vector>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Solvers
{
  enum class Preconditioner
  {
    jacobi,    ///< the diagonal
    amg,       ///< smoothed aggregation (Trilinos ML) with rigid-body modes
    cholesky,  ///< incomplete factor of each rank's own unknowns
    geometric, ///< multigrid of the operator's own
    automatic  ///< that where the method finds it worth while, else amg
  };

  /// Further choices of a method.
  enum class MorePreconditioners
  {
    none,
    cholesky,
    geometric
  };

  struct LinearSolverSettings
  {
    Preconditioner preconditioner = Preconditioner::amg;
    double         tolerance      = 1e-8; ///< residual over right-hand side, where the solve is to be exact
    unsigned int   max_iterations = 5000;

    /// Declares and reads the entries in the current section. @param more what the method's operators can do besides
    void add(Parameters &p, MorePreconditioners more = MorePreconditioners::none);
  };

  struct LinearResult
  {
    bool         converged  = false; ///< false also where a number was not finite
    unsigned int iterations = 0;
  };

  /**
   * Solves the linear systems of Newton's method: conjugate gradients where they are symmetric positive definite, GMRES
   * preconditioned from the right, which controls the true residual as well, where they are not symmetric.
   *
   * The multigrid hierarchy, or the factor, of an earlier matrix is kept while the iterations lost to its age are fewer than a set-up
   * is worth; a solve that exceeds this on its way stops, sets up anew and goes on from where it was. The decision rests on
   * iteration counts alone, never on time, so that a run repeats to the last digit.
   *
   * All calls are collective. The hierarchy refers to the matrix: call forget() before the matrix or its pattern goes.
   */
  class LinearSolver
  {
  public:
    explicit LinearSolver(const LinearSolverSettings &settings);

    /// What a coarse grid must represent: the 3 (2D) or 6 (3D) rigid-body motions, zero on constrained unknowns, with
    /// the unknowns of a node numbered one after the other. Needed before the first solve with multigrid; forgets.
    void set_near_null_space(const std::vector<Vector> &modes);

    /// Whether the matrices to come are symmetric, as they are at first; forgets where that is news.
    void set_symmetric(bool symmetric);

    /// Solves K x = b to |b - K x| <= tolerance * |b|. Rows of K that hold only their diagonal (constrained unknowns)
    /// are solved exactly and left out of both norms. The start is zero, whatever x holds; x has the layout of b.
    /// Reports failure (no convergence, not finite, no hierarchy) on all ranks alike instead of throwing.
    LinearResult solve(const Matrix &K, Vector &x, const Vector &b, double relative_tolerance);

    /// The same of an operator, whose decoupled rows it solves itself.
    LinearResult solve_lifted(Operator &A, Vector &x, const Vector &b, double relative_tolerance);

    /// Solves A x = b likewise, A symmetric positive definite; the preconditioner is made of A.diagonal() at every solve, or
    /// now and then of A.approximation() or A.own_block(). Held unknowns must be 0 in b and left alone by A: A x = x there.
    /// @param tolerance of |b - A x| itself
    LinearResult solve(Operator &A, Vector &x, const Vector &b, double tolerance);

    /// Drops the preconditioner, for a new pattern or where a checkpoint is written or read.
    void forget();

    /// What a run must save, besides the matrix that the preconditioner was made of, to go on as if it had not been stopped.
    struct Memory
    {
      bool                is_set_up = false;
      std::vector<double> near_null_space;
      unsigned int        n_modes               = 0;
      double              iterations_per_decade = 0., iterations_lost = 0.;
    };
    Memory memory() const;
    /// @param A what solve() will be called with @param K the matrix that multigrid was made of
    void resume(const Memory &memory, const Operator &A, const Matrix &K);
    /// @param own_block what the factor was made of
    void resume(const Memory &memory, const Operator &A, const SparseRows &own_block);

    const LinearSolverSettings &
    get_settings() const
    {
      return settings;
    }

    unsigned long
    total_iterations() const
    {
      return n_iterations;
    }
    unsigned long
    setups() const
    {
      return n_setups;
    }

  private:
    struct Attempt
    {
      LinearResult result;
      double       decades = 0.; ///< by which the residual fell
    };

    LinearResult solve_coupled(Operator &A, Vector &x, const Vector &b, double tolerance);
    Attempt      iterate(dealii::SolverControl &control, const Operator &A, Vector &x, const Vector &b);
    void         run_krylov(dealii::SolverControl &control, const Operator &A, Vector &x, const Vector &b) const;
    bool         set_up(Operator &A, const Vector &layout);
    bool         set_up_jacobi(const Operator &A, const Vector &layout);
    void         set_up_multigrid(const Matrix &K);
    bool
    is_set_up() const
    {
      return multigrid != nullptr || factor || has_own_multigrid;
    }
    void   remember(const Memory &memory, const Operator &A);
    bool   usable_for(const Operator &A) const;
    double setup_cost() const;

    LinearSolverSettings settings;
    bool                 is_symmetric = true;
    std::vector<double>  near_null_space; ///< ML's layout: one mode after the other, locally owned entries
    unsigned int         n_modes = 0;

    std::unique_ptr<dealii::TrilinosWrappers::PreconditionBase> multigrid;
    std::optional<IncompleteCholesky>                           factor;
    Vector                                                      inverse_diagonal; ///< of jacobi
    bool          has_own_multigrid     = false;   ///< the operator has set up one of its own
    const void   *set_up_for            = nullptr; ///< identity of the operator
    double        iterations_per_decade = 0.;      ///< with a fresh hierarchy; 0 before its first solve
    double        iterations_lost       = 0.;      ///< to the age of the hierarchy, since its set-up
    unsigned long n_iterations          = 0;
    unsigned long n_setups              = 0;
  };
} // namespace Stroma::Solvers
