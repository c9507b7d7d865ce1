#pragma once

#include "fixture.h"

#include <stroma/solvers/linear_solver.h>
#include <stroma/solvers/newton.h>

#include <gtest/gtest.h>

/// Solves with exact linear solves to round-off; the residual after each Newton iteration, over the internal force.
template <int dim>
inline std::vector<double>
solve_exactly(SystemFixture<dim> &s, Stroma::Vector &u)
{
  Stroma::Solvers::NewtonSettings       newton_settings;
  Stroma::Solvers::LinearSolverSettings linear_settings;
  newton_settings.inexact                = false;
  newton_settings.displacement_tolerance = newton_settings.energy_tolerance = 1e-14;
  linear_settings.tolerance                                                 = 1e-13;
  Stroma::Solvers::LinearSolver linear_solver(linear_settings);
  linear_solver.set_near_null_space(s.system->rigid_motions());
  std::vector<double>           residuals;
  const Stroma::Solvers::Newton newton(newton_settings, [&](unsigned int, const double residual, double, double,
                                                            unsigned int) { residuals.push_back(residual); });
  Stroma::Matrix                K;
  u = s.system->new_vector();
  EXPECT_EQ(newton.solve(*s.system, linear_solver, K, u).status, Stroma::StepStatus::ok);
  for (double &residual : residuals)
    residual /= s.system->force_scale();
  return residuals;
}
