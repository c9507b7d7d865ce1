#pragma once

#include <stroma/rigid/contact_term.h>
#include <stroma/solvers/newton.h>
#include <stroma/solvers/sum_of_terms.h>

namespace Stroma::Rigid
{
  /// Tells the contacts @p touching of @p system that a step starts from displacement @p u (owned unknowns). Collective.
  template <int dim>
  void start_step(Solvers::SumOfTerms &system, ContactTerm<dim> &touching, const Vector &u);

  /**
   * One stage of a step, with contact: bodies that touch nothing are moved up to the material, then Newton's method and
   * ContactTerm::update() take turns until neither changes anything. Without contacts it is Newton's method. Collective.
   * @param u in: the first guess; out: the solution (owned unknowns, those that follow others too)
   * @param seen is told of each of Newton's solves
   */
  template <int dim>
  StepStatus solve_in_rounds(const Solvers::Newton &newton, Solvers::SumOfTerms &system, ContactTerm<dim> &touching,
                             Solvers::LinearSolver &linear_solver, Matrix &K, Vector &u,
                             const std::function<void(const Solvers::NewtonResult &)> &seen);
} // namespace Stroma::Rigid
