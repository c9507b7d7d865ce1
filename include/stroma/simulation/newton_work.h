#pragma once

#include <stroma/simulation/method.h>
#include <stroma/solvers/newton.h>

#include <algorithm>

namespace Stroma
{
  /// Adds one of Newton's solves to the work of a step.
  inline void
  add(StepWork &work, const Solvers::NewtonResult &result)
  {
    work.newton_iterations += result.iterations;
    work.hardest_solve = std::max(work.hardest_solve, result.iterations);
    work.linear_iterations += result.linear_iterations;
    work.residual_evaluations += result.residual_evaluations;
  }
} // namespace Stroma
