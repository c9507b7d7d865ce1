#include <stroma/rigid/contact_rounds.h>

namespace Stroma::Rigid
{
  namespace
  {
    constexpr unsigned int max_rounds = 60; ///< after which a step has failed
    /// So many rounds, which mostly find what touches, are solved to tolerances looser by this factor. Later ones, that
    /// points change in whose force is next to nothing, are not.
    constexpr unsigned int loose_rounds = 2;
    constexpr double       looser       = 1e4;
  }

  template <int dim>
  void
  start_step(Solvers::SumOfTerms &system, ContactTerm<dim> &touching, const Vector &u)
  {
    if (touching.empty())
      return;
    Vector whole(u);
    touching.start_step(system.with_ghosts(whole));
  }

  template <int dim>
  StepStatus
  solve_in_rounds(const Solvers::Newton &newton, Solvers::SumOfTerms &system, ContactTerm<dim> &touching,
                  Solvers::LinearSolver &linear_solver, Matrix &K, Vector &u,
                  const std::function<void(const Solvers::NewtonResult &)> &seen)
  {
    if (const StepStatus status = touching.approach(u, system.external_forces(), system.time());
        status != StepStatus::ok)
      return status;
    Solvers::NewtonScale scale;
    bool                 is_settled = touching.empty();
    for (unsigned int round = 0; round < max_rounds; ++round)
      {
        const bool is_loose    = !is_settled && round < loose_rounds;
        scale.tolerance_factor = is_loose ? looser : 1.;
        const auto result      = newton.solve(system, linear_solver, K, u, scale);
        seen(result);
        if (result.status != StepStatus::ok)
          return result.status;
        const Vector &relevant = system.with_ghosts(u);
        is_settled             = touching.empty() || !touching.update(relevant);
        if (is_settled && !is_loose)
          return StepStatus::ok;
      }
    return touching.failure();
  }

#define INSTANTIATE(dim)                                                                                               \
  template void       start_step(Solvers::SumOfTerms &, ContactTerm<dim> &, const Vector &);                           \
  template StepStatus solve_in_rounds(const Solvers::Newton &, Solvers::SumOfTerms &, ContactTerm<dim> &,              \
                                      Solvers::LinearSolver &, Matrix &, Vector &,                                     \
                                      const std::function<void(const Solvers::NewtonResult &)> &);
  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Stroma::Rigid
