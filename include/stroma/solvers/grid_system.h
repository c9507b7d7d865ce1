#pragma once

#include <stroma/base/step_status.h>
#include <stroma/solvers/operator.h>

namespace Stroma::Solvers
{
  /**
   * What Newton sees of a method: the out-of-balance force of a displacement u and its tangent. Called per iteration,
   * never per point. Every call is collective; every status is already reduced over the ranks.
   */
  class GridSystem
  {
  public:
    virtual ~GridSystem() = default;

    /// r = f_ext - f_int(u) [N] on free unknowns, 0 on constrained ones.
    /// @param u fully distributed (no ghosts), like r
    virtual StepStatus residual(Vector &r, const Vector &u) = 0;

    /// K = -dr/du with constrained rows and columns replaced by a positive diagonal. Constrained unknowns of u that do
    /// not have their prescribed value yet (the jump of a new step) are lifted: r_c = diag * jump, r_f -= K_fc * jump,
    /// so that solving K du = r moves them all the way.
    /// @param r in: residual(u); out: the right-hand side
    virtual StepStatus tangent(Matrix &K, Vector &r, const Vector &u) = 0;

    /// The tangent where the system keeps it, not assembled: tangent() fills this, and K stays empty. Else nullptr.
    virtual Operator *
    kept_tangent()
    {
      return nullptr;
    }

    /// Whether tangent() gives a symmetric matrix: conjugate gradients solve with it, or GMRES.
    virtual bool
    symmetric() const
    {
      return true;
    }

    /// Norm of the internal forces met by the last residual(), reactions included [N].
    virtual double force_scale() const = 0;

    /// What the numbers of the last residual() can resolve [N]: the norm of the round-off of all its terms, taken before
    /// they cancel. A residual below that is as good as zero, also where nothing moves or force_scale() itself is noise.
    virtual double round_off() const = 0;
  };
} // namespace Stroma::Solvers
