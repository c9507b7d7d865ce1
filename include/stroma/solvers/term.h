#pragma once

#include <stroma/base/step_status.h>
#include <stroma/solvers/time_scheme.h>

#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

namespace Stroma::Solvers
{
  using Constraints = dealii::AffineConstraints<double>;
  using Pattern     = dealii::TrilinosWrappers::SparsityPattern;

  /**
   * One of the forces whose sum is to vanish: of cells, of driven points, of contact. SumOfTerms calls all its terms on all
   * ranks, whatever the status of others, and compresses the sums; a status is that of this rank.
   *
   * Motions hold all relevant unknowns, with ghosts; v and a are empty where the scene does not need them.
   */
  class Term
  {
  public:
    virtual ~Term() = default;

    /// Adds the places that add_tangent() writes to.
    virtual void add_pattern(Pattern &pattern, const Constraints &constraints) const = 0;

    /// Adds the force at @p motion to @p r [N].
    virtual StepStatus add_force(Vector &r, const Motion &motion, const Stage &stage) = 0;

    /// Adds minus its derivative along u to @p K, and to @p r what the jumps of held unknowns, the inhomogeneities of
    /// @p constraints, do to the others.
    virtual StepStatus add_tangent(Matrix &K, Vector &r, const Motion &motion, const Stage &stage,
                                   const Constraints &constraints) = 0;

    /// Whether add_tangent() adds a symmetric matrix.
    virtual bool
    symmetric() const
    {
      return true;
    }

    /// Whether add_tangent() adds nothing but symmetric matrices of cells whose rows sum up to zero over the nodes, so that the
    /// tangent need not be assembled; the same on all ranks.
    virtual bool
    acts_in_cells_only() const
    {
      return false;
    }

    /// What the numbers of the last add_force() resolve [N]: the round-off of all that it summed up, taken before anything
    /// cancels. Collective.
    virtual double round_off() const = 0;

    /// Keeps what the next step starts from; @p motion is that of the end of the step.
    virtual void
    commit(const Motion & /*motion*/, const Stage & /*stage*/)
    {}
  };
} // namespace Stroma::Solvers
