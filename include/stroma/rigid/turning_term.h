#pragma once

#include <stroma/rigid/unknowns.h>

namespace Stroma::Rigid
{
  /// The torques of loads on rigid bodies, and what turning a body does to all forces on it: the tangent of the forces
  /// conjugate to its rotation at fixed forces on the nodes tied to it. Other forces bring their own.
  template <int dim>
  class TurningTerm : public Solvers::Term
  {
  public:
    TurningTerm(const Scene<dim> &scene, const Unknowns<dim> &unknowns);

    void add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const override;
    /// Local.
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    /// In space torques about fixed axes have no potential.
    bool symmetric() const override;
    /// Collective.
    double round_off() const override;

    /// Of the last add_force(), conjugate to an owned unknown of a rigid body [N].
    double
    force(const dealii::types::global_dof_index dof) const
    {
      return last.empty() ? 0. : last[dof - unknowns.unknown(0, 0)];
    }

    std::vector<dealii::Tensor<2, dim>> virials; ///< of the forces on nodes tied to each body

  private:
    bool                                         turns_freely(unsigned int b) const;
    Axial<dim>                                   rotation(unsigned int b, const Vector &u) const;
    std::vector<dealii::types::global_dof_index> dofs(unsigned int b) const;

    const Scene<dim>    &scene;
    const Unknowns<dim> &unknowns;
    std::vector<double>  last; ///< by unknowns of rigid bodies
  };
} // namespace Stroma::Rigid
