#include <stroma/base/log.h>
#include <stroma/base/parameters.h>
#include <stroma/base/text.h>
#include <stroma/solvers/newton.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace Stroma::Solvers
{
  namespace
  {
    /// Part of the first slope du . r that may be left after a step, see acceptable().
    constexpr double       curvature    = .9;
    constexpr unsigned int max_halvings = 6;
    /// A tangent is kept after a whole step that leaves no more of the residual than this part, about what the first linear solve
    /// leaves of it: then the problem is all but linear, and the next step leaves about as little again.
    constexpr double serves = 3e-5;

    /// Tolerance of the next linear solve, relative to its right-hand side.
    class Forcing
    {
    public:
      Forcing(const NewtonSettings &settings, const double exact_tolerance)
        : settings(settings)
        , exact_tolerance(exact_tolerance)
      {}

      /// Eisenstat & Walker, SIAM J. Sci. Comput. 17 (1996) 16-32, eq. (2.6) and its safeguard, with gamma = .9 and
      /// exponent 2. Never tighter than what the residual may still be when the tolerances of eq. (9) are met.
      /// @param norm of the right-hand side
      double
      next(const double norm)
      {
        if (!settings.inexact)
          return exact_tolerance;
        double tolerance = first;
        if (previous_norm > 0.)
          {
            tolerance = .9 * std::pow(norm / previous_norm, 2);
            if (const double guard = .9 * previous * previous; guard > .1 * largest)
              tolerance = std::max(tolerance, guard);
          }
        else
          first_norm = norm;
        const double goal = .5 * std::min(settings.displacement_tolerance, std::sqrt(settings.energy_tolerance));
        if (previous_norm > 0.)
          tolerance = std::max(tolerance, goal * first_norm / norm);
        previous_norm = norm;
        previous      = std::max(std::min(tolerance, largest), exact_tolerance);
        return previous;
      }

    private:
      static constexpr double largest = 1e-2;
      /// The right-hand side of a step's first solve is mostly the jump of the held unknowns, large and local: the smooth
      /// part of the solution is good only when much less than that is left. A loose first solve costs tangents later.
      static constexpr double first = 1e-5;

      const NewtonSettings &settings;
      const double          exact_tolerance;
      double                first_norm    = 0.;
      double                previous_norm = 0.;
      double                previous      = 0.;
    };

    /// One solve of Newton's method: what is carried from one iteration to the next.
    class Solve
    {
    public:
      Solve(GridSystem &system, LinearSolver &linear_solver, Matrix &K, const Vector &guess,
            const NewtonSettings &settings, NewtonScale &scale)
        : u(guess)
        , system(system)
        , linear_solver(linear_solver)
        , K(K)
        , settings(settings)
        , scale(scale)
        , forcing(settings, linear_solver.get_settings().tolerance)
        , r(guess)
        , du(guess)
      {}

      StepStatus run(const Newton::Progress &progress);

      Vector       u; ///< accepted so far
      NewtonResult result;

    private:
      bool
      balanced() const
      {
        return r.l2_norm() <= system.round_off();
      }
      bool       converged() const;
      bool       asks_too_much() const;
      StepStatus evaluate(Vector &residual, const Vector &displacement);
      StepStatus find_increment(unsigned int &linear_iterations);
      StepStatus apply_increment();
      bool       acceptable(const Vector &r_trial) const;

      GridSystem           &system;
      LinearSolver         &linear_solver;
      Matrix               &K;
      const NewtonSettings &settings;
      NewtonScale          &scale;
      Forcing               forcing;

      Vector r, du;
      bool   full_step = false; ///< the last du was taken whole, so all constrained unknowns are where they should be
      bool   keep      = false; ///< the tangent serves the next iteration
      double slope     = 0.;    ///< |du . r|
      double displacement_ratio = 1., energy_ratio = 1.;
    };

    StepStatus
    Solve::run(const Newton::Progress &progress)
    {
      StepStatus status = evaluate(r, u);
      while (status == StepStatus::ok)
        {
          if (full_step && (balanced() || converged()))
            {
              result.below_round_off = asks_too_much();
              return StepStatus::ok;
            }
          if (result.iterations == settings.max_iterations)
            return StepStatus::diverged;
          if (!keep)
            {
              status = system.tangent(K, r, u);
              ++result.tangent_assemblies;
            }
          if (status != StepStatus::ok)
            return status;
          if (!full_step && balanced()) // now that r holds what a jump would do
            return StepStatus::ok;
          unsigned int linear_iterations = 0;
          status                         = find_increment(linear_iterations);
          if (status == StepStatus::ok)
            status = apply_increment();
          if (status != StepStatus::ok && keep) // the tangent serves no longer; on with that of this state
            {
              keep = full_step = false;
              status           = StepStatus::ok;
              continue;
            }
          if (status == StepStatus::ok && progress)
            progress(result.iterations, r.l2_norm(), displacement_ratio, energy_ratio, linear_iterations);
        }
      return status;
    }

    bool
    Solve::converged() const
    {
      const double factor = scale.tolerance_factor;
      return displacement_ratio < factor * settings.displacement_tolerance &&
             energy_ratio < factor * factor * settings.energy_tolerance;
    }

    /// Whether the tolerances were not met because no residual as small as they ask for can be told from zero.
    bool
    Solve::asks_too_much() const
    {
      const double tolerance = std::min(settings.displacement_tolerance, std::sqrt(settings.energy_tolerance));
      return !converged() && tolerance * std::max(scale.largest_force, system.force_scale()) < system.round_off();
    }

    StepStatus
    Solve::evaluate(Vector &residual, const Vector &displacement)
    {
      ++result.residual_evaluations;
      const StepStatus status = system.residual(residual, displacement);
      if (status == StepStatus::ok && !std::isfinite(residual.l2_norm()))
        return StepStatus::not_finite;
      return status;
    }

    /// K du = r, and the ratios of eq. (9).
    StepStatus
    Solve::find_increment(unsigned int &linear_iterations)
    {
      const double       tolerance = forcing.next(r.l2_norm());
      Operator *const    kept      = system.kept_tangent();
      const LinearResult linear    = kept != nullptr ? linear_solver.solve_lifted(*kept, du, r, tolerance) :
                                                       linear_solver.solve(K, du, r, tolerance);
      linear_iterations            = linear.iterations;
      result.linear_iterations += linear.iterations;
      ++result.iterations;
      const double norm = du.l2_norm();
      if (!std::isfinite(norm))
        return StepStatus::not_finite;
      if (!linear.converged)
        return StepStatus::linear_failed;
      slope = std::abs(du * r);
      if (result.iterations == 1)
        scale.first_slope = std::max(scale.first_slope, slope);
      scale.largest_force     = std::max(scale.largest_force, r.l2_norm());
      scale.largest_increment = std::max(scale.largest_increment, norm);
      displacement_ratio      = norm / scale.largest_increment;
      energy_ratio            = slope / scale.first_slope;
      return StepStatus::ok;
    }

    /// u += s du with s = 1, 1/2, 1/4, ... whatever is acceptable first; r follows.
    StepStatus
    Solve::apply_increment()
    {
      Vector     r_trial(r); // not there, as trial, while the linear solver needs vectors of its own
      StepStatus status = StepStatus::diverged;
      double     length = 1.;
      for (unsigned int halvings = 0; halvings <= max_halvings; ++halvings, length *= .5)
        {
          Vector trial(u);
          trial.add(length, du);
          status = evaluate(r_trial, trial);
          if (status == StepStatus::ok && acceptable(r_trial))
            {
              u.swap(trial);
              r.swap(r_trial);
              full_step = halvings == 0;
              keep      = full_step && r.l2_norm() <= serves * r_trial.l2_norm();
              return StepStatus::ok;
            }
        }
      return worse(status, StepStatus::diverged);
    }

    /// du . r is the slope of the energy along du (of the potential whose gradient is -r), zero at its minimum. A step
    /// is acceptable if it leaves less of the slope than most of it, or a smaller residual than there was. At round-off
    /// neither need be so.
    bool
    Solve::acceptable(const Vector &r_trial) const
    {
      const double norm = r_trial.l2_norm();
      return std::abs(du * r_trial) <= curvature * slope || norm <= r.l2_norm() || norm <= system.round_off();
    }
  } // namespace

  void
  NewtonSettings::add(Parameters &p)
  {
    p.add("Displacement tolerance", displacement_tolerance,
          "eps_d: an increment over the largest one of the step (Guilkey et al. 2006, eq. 9)", "", Range::open(0., 1.));
    p.add("Energy tolerance", energy_tolerance,
          "eps_e: increment times residual over the first such product of the step (same)", "", Range::open(0., 1.));
    p.add("Maximum iterations", max_iterations, "iterations after which the step is cut", Range::at_least(1.));
    p.add("Inexact", inexact, "solve the linear systems only as well as the iteration needs (Eisenstat & Walker 1996)");
  }

  Newton::Newton(const NewtonSettings &settings, Progress progress)
    : settings(settings)
    , progress(std::move(progress))
  {}

  NewtonResult
  Newton::solve(GridSystem &system, LinearSolver &linear_solver, Matrix &K, Vector &u) const
  {
    NewtonScale scale;
    return solve(system, linear_solver, K, u, scale);
  }

  NewtonResult
  Newton::solve(GridSystem &system, LinearSolver &linear_solver, Matrix &K, Vector &u, NewtonScale &scale) const
  {
    linear_solver.set_symmetric(system.symmetric());
    Solve solve(system, linear_solver, K, u, settings, scale);
    solve.result.status = solve.run(progress);
    if (solve.result.status == StepStatus::ok)
      u.swap(solve.u);
    return solve.result;
  }

  void
  RoundOffCount::add(const NewtonResult &result, const double t)
  {
    if (!result.below_round_off)
      return;
    if (count++ == 0)
      Log::warning("Newton's tolerances ask for more than the numbers resolve in the step from t = " + brief(t) +
                   " s: it stops at the round-off of the forces; the summary counts the solves where it does so");
  }

  Newton::Progress
  print_iterations()
  {
    return [](const unsigned int iteration, const double residual, const double displacement, const double energy,
              const unsigned int linear_iterations) {
      char line[160];
      std::snprintf(line, sizeof(line), "      Newton %2u: residual %.2e N, |du|/max %.1e, energy ratio %.1e, %u CG",
                    iteration, residual, displacement, energy, linear_iterations);
      Log::line(line);
    };
  }
} // namespace Stroma::Solvers
