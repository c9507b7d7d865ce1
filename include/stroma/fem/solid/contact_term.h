#pragma once

#include <stroma/fem/solid/contact.h>
#include <stroma/solvers/term.h>

#include <limits>

namespace Stroma::Fem
{
  /// The forces of all contacts of a scene, on the solid and on the rigid bodies.
  template <int dim>
  class ContactTerm : public Solvers::Term
  {
  public:
    explicit ContactTerm(const std::vector<RigidContact<dim>> &contacts)
      : contacts(contacts)
    {}

    void
    add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const override
    {
      for (const auto &contact : contacts)
        contact.add_pattern(pattern, constraints);
    }

    /// Collective.
    StepStatus
    add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &) override
    {
      summed = 0.;
      if (contacts.empty())
        return StepStatus::ok;
      last.reinit(r);
      for (const auto &contact : contacts)
        {
          contact.add_force(last, motion.u);
          summed += contact.summed_force(motion.u);
        }
      last.compress(dealii::VectorOperation::add);
      r += last;
      return StepStatus::ok;
    }

    StepStatus
    add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &,
                const Solvers::Constraints &constraints) override
    {
      for (const auto &contact : contacts)
        contact.add_stiffness(K, r, motion.u, constraints);
      return StepStatus::ok;
    }

    double
    round_off() const override
    {
      return std::numeric_limits<double>::epsilon() * summed;
    }

    /// The force of the last add_force() [N]; empty without contacts.
    const Vector &
    force() const
    {
      return last;
    }

  private:
    const std::vector<RigidContact<dim>> &contacts;
    Vector                                last;
    double                                summed = 0.; ///< [N]
  };
} // namespace Stroma::Fem
