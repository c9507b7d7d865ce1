#pragma once

#include <stroma/solvers/grid_system.h>
#include <stroma/solvers/linear_solver.h>

#include <cstdint>
#include <functional>

namespace Stroma::Solvers
{
  struct NewtonSettings
  {
    double       displacement_tolerance = 1e-6; ///< eps_d of Guilkey et al. (2006), eq. (9)
    double       energy_tolerance       = 1e-9; ///< eps_e of the same
    unsigned int max_iterations         = 20;
    bool         inexact                = true; ///< solve the linear systems only as well as the iteration needs

    /// Declares and reads the entries in the current section.
    void add(Parameters &p);
  };

  struct NewtonResult
  {
    StepStatus   status               = StepStatus::ok;
    unsigned int iterations           = 0; ///< linear systems solved
    unsigned int linear_iterations    = 0;
    unsigned int residual_evaluations = 0;
    unsigned int tangent_assemblies   = 0;
    bool         below_round_off = false; ///< the tolerances ask for more than the numbers resolve; it stopped there
  };

  /// What eq. (9) measures increments against. Solves of one step that follow each other, as those of contact do, share it.
  struct NewtonScale
  {
    double largest_increment = 0.; ///< |du^max|; 0 before the first solve
    double first_slope       = 0.; ///< |du^0 . Q^0|, the largest of the solves
    double largest_force     = 0.; ///< of all |Q^k|
    double tolerance_factor  = 1.; ///< times eps_d, squared times eps_e: above 1 where the next solve moves u anyway
  };

  /**
   * Newton's method for the balance of forces, r(u) = 0.
   *
   * It has converged when |du^k| / |du^max| < eps_d and |du^k . Q^k| / |du^0 . Q^0| < eps_e (Guilkey et al. 2006,
   * eq. 9), with plain norms, du^max the largest du of this solve (or of all that share a NewtonScale) and Q^k the
   * right-hand side that gave du^k; or when |r| is at the round-off of the forces it is the sum of
   * (GridSystem::round_off), which may be so at the start. du^k is applied either way, and the system's last residual()
   * is the one of the accepted u, so that its reactions are current.
   *
   * A step is halved while it turns points inside out or overshoots (see acceptable()). With inexact solves the
   * tolerance follows Eisenstat & Walker (1996), choice 2.
   */
  class Newton
  {
  public:
    /// Called after each iteration with |r|, the two ratios of eq. (9) and the iterations of the linear solve.
    using Progress = std::function<void(unsigned int iteration, double residual_norm, double displacement_ratio,
                                        double energy_ratio, unsigned int linear_iterations)>;

    explicit Newton(const NewtonSettings &settings, Progress progress = {});

    /// @param u in: the first guess, whose constrained unknowns may still lack the step's jump; out: the solution, or
    /// unchanged if the status is not ok. Collective.
    NewtonResult solve(GridSystem &system, LinearSolver &linear_solver, Matrix &K, Vector &u) const;
    /// The same, with a @p scale that goes on from an earlier solve. Collective.
    NewtonResult solve(GridSystem &system, LinearSolver &linear_solver, Matrix &K, Vector &u, NewtonScale &scale) const;

  private:
    NewtonSettings settings;
    Progress       progress;
  };

  /// Counts the solves that stopped at round-off, short of tolerances that no numbers of this size could meet; says the
  /// first.
  class RoundOffCount
  {
  public:
    void add(const NewtonResult &result, double t);

    std::uint64_t count = 0;
  };

  /// Prints a line an iteration.
  Newton::Progress print_iterations();
} // namespace Stroma::Solvers
