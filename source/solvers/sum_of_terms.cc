#include <stroma/solvers/sum_of_terms.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Solvers
{
  SumOfTerms::SumOfTerms(Timers &timers, const MPI_Comm comm)
    : timers(timers)
    , comm(comm)
  {}

  void
  SumOfTerms::reinit(const dealii::IndexSet &owned_unknowns, const dealii::IndexSet &relevant_unknowns,
                     const Rates rates, const bool has_external)
  {
    owned    = owned_unknowns;
    relevant = relevant_unknowns;
    unbalanced.reinit(owned, comm);
    if (has_external)
      external.reinit(owned, comm);
    motion.u.reinit(owned, relevant, comm);
    if (rates.velocity)
      motion.v.reinit(owned, relevant, comm);
    if (rates.acceleration)
      motion.a.reinit(owned, relevant, comm);
  }

  void
  SumOfTerms::shape(Matrix &K) const
  {
    if (K.m() > 0)
      return;
    Pattern    pattern(owned, owned, relevant, comm);
    const auto homogeneous = pattern_constraints();
    for (const auto *term : terms)
      term->add_pattern(pattern, homogeneous);
    add_pattern(pattern);
    pattern.compress();
    K.reinit(pattern);
  }

  const Vector &
  SumOfTerms::with_ghosts(Vector &u)
  {
    tie(u);
    motion.u = u;
    return motion.u;
  }

  void
  SumOfTerms::find_motion(const Vector &u)
  {
    Vector whole(u);
    tie(whole);
    motion.u        = whole;
    const auto find = [&](Vector &rate, const double factor, const Vector &known) {
      if (rate.size() == 0)
        return;
      Vector value(whole);
      value *= factor;
      if (known.size() > 0)
        value += known;
      tie_rate(value);
      rate = value;
    };
    find(motion.v, stage.v_factor, stage.v_known);
    find(motion.a, stage.a_factor, stage.a_known);
  }

  StepStatus
  SumOfTerms::sum_terms()
  {
    unbalanced        = 0.;
    StepStatus status = StepStatus::ok;
    for (auto *term : terms)
      status = worse(status, term->add_force(unbalanced, motion, stage));
    unbalanced.compress(dealii::VectorOperation::add);
    return reduce(status, comm);
  }

  StepStatus
  SumOfTerms::residual(Vector &r, const Vector &u)
  {
    const auto scope = timers.scope("residual");
    find_motion(u);
    const StepStatus status = sum_terms();
    if (status != StepStatus::ok)
      return status;
    internal_force_norm = unbalanced.l2_norm();
    if (!std::isfinite(internal_force_norm))
      return StepStatus::not_finite;
    round_off_norm = 0.;
    for (const auto *term : terms)
      round_off_norm += term->round_off();
    if (external.size() > 0)
      {
        round_off_norm += std::numeric_limits<double>::epsilon() * external.l2_norm();
        unbalanced += external;
      }
    condense(unbalanced);
    r = unbalanced;
    for (const auto &unknown : held)
      if (owned.is_element(unknown.dof))
        r(unknown.dof) = 0.;
    r.compress(dealii::VectorOperation::insert);
    return StepStatus::ok;
  }

  StepStatus
  SumOfTerms::tangent(Matrix &K, Vector &r, const Vector &u)
  {
    const auto scope = timers.scope("stiffness");
    find_motion(u);
    std::vector<double> jump; // of held unknowns that do not have their prescribed value yet
    for (const auto &unknown : held)
      jump.push_back(unknown.target - motion.u(unknown.dof));
    if (is_assembled(jump))
      return StepStatus::ok;
    shape(K);
    K                 = 0.;
    const auto lifted = constraints(jump);
    StepStatus status = StepStatus::ok;
    for (auto *term : terms)
      status = worse(status, term->add_tangent(K, r, motion, stage, lifted));
    K.compress(dealii::VectorOperation::add);
    r.compress(dealii::VectorOperation::add);
    fill_empty_rows(K, r, lifted);
    return reduce(status, comm);
  }

  bool
  SumOfTerms::symmetric() const
  {
    return std::all_of(terms.begin(), terms.end(), [](const Term *term) { return term->symmetric(); });
  }

  void
  SumOfTerms::commit()
  {
    for (auto *term : terms)
      term->commit(motion, stage);
  }

  std::vector<std::pair<std::string, bool>>
  SumOfTerms::vectors() const
  {
    return {{"unbalanced force", unbalanced.size() > 0},
            {"external force", external.size() > 0},
            {"displacement with ghosts", motion.u.size() > 0},
            {"velocity with ghosts", motion.v.size() > 0},
            {"acceleration with ghosts", motion.a.size() > 0}};
  }
} // namespace Stroma::Solvers
