#pragma once

#include <stroma/fem/loads.h>
#include <stroma/fem/solid/cells.h>
#include <stroma/rigid/contact_term.h>
#include <stroma/rigid/inertia_term.h>
#include <stroma/rigid/turning_term.h>
#include <stroma/solvers/linear_solver.h>
#include <stroma/solvers/sum_of_terms.h>

namespace Stroma::Fem
{
  /// The equations of one implicit solve of a solid on its mesh: f_ext - f_int(u, v, a) + f_contact(u) = 0.
  template <int dim>
  class SolidSystem : public Solvers::SumOfTerms
  {
  public:
    SolidSystem(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh, Unknowns<dim> &unknowns,
                Timers &timers);

    /// Supports and loads at the stage's time; u, v and a are related as the stage says. @p t_next end of the step [s],
    /// @p start displacement at its start, for mean positions.
    void set_stage(const Solvers::Stage &stage, double t_next, const Vector &start);

    /// After generalized alpha has balanced the forces of a mean time: forces, reactions and energy of @p motion at the end
    /// of the step, @p t; those of contact stay as they were.
    StepStatus evaluate_end(const Solvers::Motion &motion, double t);

    /// The parts of the mesh that nothing holds. Throws UserError if loads drive them between 0 and @p end_time [s].
    /// Collective.
    FreeParts<dim> free_parts(const ConnectedParts<dim> &parts, double end_time);

    /// Gives held unknowns of the velocity @p v at the start that of their prescribed motion. @p h a short time [s].
    void start_held(Vector &v, double h) const;

    /// Solves M a = f_ext - f_int(u, v) for the acceleration at the start, with that of the prescribed motion where it is held.
    StepStatus initial_acceleration(Solvers::LinearSolver &solver, Matrix &K, Vector &a, const Vector &u,
                                    const Vector &v, double h);

    /// Force by which each support holds the bodies, [support][component], from the last residual() [N]. Collective.
    std::vector<dealii::Tensor<1, dim>> reactions() const;
    /// reaction_BODY_x_N, ...: force by which each rigid body at rest holds the others [N]. Collective.
    std::vector<std::pair<std::string, double>> reactions_at_rest() const;
    /// Results of all rigid bodies at displacement @p u, with the forces of the last residual(). Collective.
    std::vector<std::pair<std::string, double>> rigid_scalars(const Vector &u);
    /// Strain energy at the last residual() [J]. Collective.
    double
    strain_energy() const
    {
      return cells.strain_energy();
    }
    /// Kinetic energy at velocity @p v [J]. Collective.
    double kinetic_energy(const Vector &v);
    /// @param u displacement at the end of the step @param balanced that at which contact was brought into balance
    std::vector<std::pair<std::string, double>> contact_scalars(const Vector &u, const Vector &balanced);

    /// Calls visit(cell, integrals with F and stress at the committed motion (u, v), motion of the cell) for every owned cell.
    /// @return the worst status on this rank
    template <typename Visit>
    StepStatus
    for_each_cell(const Vector &u, const Vector &v, const Visit &visit)
    {
      motion.u = u;
      if (motion.v.size() > 0)
        motion.v = v;
      return cells.for_each_cell(motion, Solvers::Stage(), visit);
    }

    SolidCells<dim>         cells;
    Rigid::ContactTerm<dim> touching;

  private:
    void
    tie(Vector &u) const override
    {
      unknowns.distribute(u);
    }
    void
    tie_rate(Vector &v) const override
    {
      unknowns.distribute_rate(v);
    }
    void condense(Vector &force) override;
    Solvers::Constraints
    constraints(const std::vector<double> &jump) const override
    {
      return unknowns.constraints(jump);
    }
    Solvers::Constraints
    pattern_constraints() const override
    {
      return unknowns.pattern_constraints();
    }
    /// Rigid bodies have rows of their own.
    void
    add_pattern(Solvers::Pattern &pattern) const override
    {
      unknowns.inclusions.add_pattern(pattern);
    }
    bool is_assembled(const std::vector<double> &jump) override;
    void
    fill_empty_rows(Matrix &K, Vector &r, const Solvers::Constraints &constraints) const override
    {
      unknowns.inclusions.fill_empty_rows(K, r, constraints);
    }

    void                find_targets(double t_next, const Vector &start);
    std::vector<double> prescribed_accelerations(double h) const;

    const Scene<dim>       &scene;
    const Settings<dim>    &settings;
    const Mesh<dim>        &mesh;
    Unknowns<dim>          &unknowns;
    Loads<dim>              loads;
    Rigid::TurningTerm<dim> turning;
    Rigid::InertiaTerm<dim> inertia;           ///< of rigid bodies
    std::array<double, 3>   assembled_factors; ///< of the stage whose tangent was assembled last; NaN: none
  };
} // namespace Stroma::Fem
