#pragma once

#include <stroma/rigid/unknowns.h>

namespace Stroma::Rigid
{
  /// The inertia of rigid bodies with a mass, -m dV/dt, in the components of their translation that the balance of forces
  /// determines. They do not turn.
  template <int dim>
  class InertiaTerm : public Solvers::Term
  {
  public:
    /// @param unknowns numbered already
    InertiaTerm(const Scene<dim> &scene, const Unknowns<dim> &unknowns);

    /// Nothing: rows of rigid bodies have their diagonal.
    void
    add_pattern(Solvers::Pattern &, const Solvers::Constraints &) const override
    {}
    /// Local.
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    /// Collective.
    double round_off() const override;

    /// Adds the masses to @p M. Local.
    void add_mass(Matrix &M, double factor = 1.) const;

    /// Of the last add_force(), on an owned unknown of a rigid body [N].
    double force(dealii::types::global_dof_index dof) const;

    /// At velocity @p v (owned or relevant unknowns) [J]. Collective.
    double kinetic_energy(const Vector &v) const;

  private:
    struct Mass
    {
      dealii::types::global_dof_index dof;
      double                          mass;       ///< m [kg]
      double                          force = 0.; ///< of the last add_force() [N]
    };

    MPI_Comm          comm;
    std::vector<Mass> masses;
  };
} // namespace Stroma::Rigid
