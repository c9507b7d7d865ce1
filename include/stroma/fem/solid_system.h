#pragma once

#include <stroma/base/log.h>
#include <stroma/fem/contact.h>
#include <stroma/fem/loads.h>
#include <stroma/fem/solid_cell.h>
#include <stroma/solvers/grid_system.h>
#include <stroma/solvers/linear_solver.h>
#include <stroma/solvers/time_scheme.h>

namespace Stroma::Fem
{
  /// The equations of one implicit solve of a solid on its mesh: f_ext - f_int(u, v, a) + f_contact(u) = 0.
  template <int dim>
  class SolidSystem : public Solvers::GridSystem
  {
  public:
    SolidSystem(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh, Unknowns<dim> &unknowns,
                Timers &timers);

    /// Supports and loads at the stage's time; u, v and a are related as the stage says. @p t_next end of the step [s],
    /// @p dt its length, for laws with history [s]; @p start displacement at its start, for mean positions.
    void set_stage(const Solvers::Stage &stage, double t_next, double dt, const Vector &start);

    StepStatus residual(Vector &r, const Vector &u) override;

    /// After generalized alpha has balanced the forces of a mean time: forces, reactions and energy of @p motion at the end
    /// of the step, @p t; those of contact stay as they were.
    StepStatus evaluate_end(const Solvers::Motion &motion, double t);
    StepStatus tangent(Matrix &K, Vector &r, const Vector &u) override;
    double     force_scale() const override { return internal_force_norm; }
    double     round_off() const override { return round_off_norm; }
    bool       symmetric() const override { return cell_forces.symmetric(); }

    /// The parts of the mesh that nothing holds. Throws UserError if loads drive them between 0 and @p end_time [s].
    /// Collective.
    FreeParts<dim> free_parts(const ConnectedParts<dim> &parts, double end_time);

    /// Brings contact forces and active sets to @p u. Whether the solution must be found anew.
    bool update_contact(const Vector &u);
    void start_step(const Vector &u);
    void restore();
    /// Moves rigid bodies that touch nothing up to the material, in the first guess @p u. False if one never would.
    bool approach(Vector &u);

    /// Keeps the state of laws with history at the end of a step of @p dt to @p u.
    void commit(const Vector &u, const Vector &v, double dt);

    /// Gives held unknowns of the velocity @p v at the start that of their prescribed motion. @p h a short time [s].
    void start_held(Vector &v, double h) const;

    /// Solves M a = f_ext - f_int(u, v) for the acceleration at the start, with that of the prescribed motion where it is held.
    StepStatus initial_acceleration(Solvers::LinearSolver &solver, Matrix &K, Vector &a, const Vector &u, const Vector &v,
                                    double h);

    void   reinit_matrix(Matrix &K) const;
    Vector new_vector() const { return Vector(unknowns.owned, comm); }

    /// Force by which each support holds the bodies, [support][component], from the last residual() [N]. Collective.
    std::vector<dealii::Tensor<1, dim>> reactions() const;
    /// reaction_BODY_x_N, ...: force by which each rigid body at rest holds the others [N]. Collective.
    std::vector<std::pair<std::string, double>> reactions_at_rest() const;
    const Vector &unbalanced_forces() const { return unbalanced; }
    /// Strain energy at the last residual() [J]. Collective.
    double strain_energy() const;
    /// Kinetic energy at velocity @p v [J]. Collective.
    double kinetic_energy(const Vector &v);
    /// @param u displacement at the end of the step @param balanced that at which contact was brought into balance
    std::vector<std::pair<std::string, double>> contact_scalars(const Vector &u, const Vector &balanced);

    /// Calls visit(cell, integrals with F and stress at the motion (u, v), motion of the cell) for every owned cell.
    /// @param step time since the history that is kept [s] @return the worst status on this rank
    template <typename Visit>
    StepStatus for_each_cell(const Vector &u, const Vector &v, const Visit &visit, double step = 0.);

    SolidCell<dim> &cell() { return cell_forces; }

    /// History of each owned quadrature point, in the order of owned cells, for a checkpoint.
    std::vector<double>            history;
    std::vector<RigidContact<dim>> contacts;

    std::vector<std::pair<std::string, bool>> vectors() const
    {
      return {{"external force", external.size() > 0},
              {"velocity with ghosts", relevant_v.size() > 0},
              {"acceleration with ghosts", relevant_a.size() > 0}};
    }

  private:
    using Motion = typename SolidCell<dim>::Motion;

    using Dofs = std::vector<dealii::types::global_dof_index>;

    /// Calls visit(cell, its unknowns) for owned cells, with cell_forces there and their motion gathered, until one fails.
    template <typename Visit>
    StepStatus for_owned_cells(const Visit &visit);
    void find_motion(const Vector &u);
    void find_round_off(double squares);
    void find_targets(double t_next, const Vector &start);
    /// @param squares set to the sum of squares of what cells sum up, on this rank
    StepStatus add_cell_forces(double &squares);
    bool is_assembled(const std::vector<double> &jump) const;
    void gather(const Dofs &dofs, Motion &motion) const;

    const Scene<dim>    &scene;
    const Settings<dim> &settings;
    const Mesh<dim>     &mesh;
    Unknowns<dim>       &unknowns;
    Timers              &timers;
    MPI_Comm             comm;

    SolidCell<dim>      cell_forces;
    Loads<dim>          loads;
    Solvers::Stage      stage;
    double              dt = 0.;
    bool                viscous;
    std::vector<double> held_target; ///< of unknowns.held [m]
    Vector              unbalanced, external, tied_u;
    Vector              touching; ///< contact forces at the last residual()
    Vector              relevant_u, relevant_v, relevant_a;
    double              internal_force_norm = 0., round_off_norm = 0., energy = 0.;
    Motion              motion; ///< of a cell
    std::array<double, 3> assembled_factors; ///< of the stage whose tangent was assembled last; NaN: none
  };

  template <int dim>
  template <typename Visit>
  StepStatus
  SolidSystem<dim>::for_owned_cells(const Visit &visit)
  {
    Dofs        dofs(unknowns.fe.n_dofs_per_cell());
    std::size_t place = 0;
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          gather(dofs, motion);
          cell_forces.reinit(cell, history.data() + place);
          place += cell_forces.n_points() * cell_forces.n_history();
          const StepStatus status = visit(cell, dofs);
          if (status != StepStatus::ok)
            return status;
        }
    return StepStatus::ok;
  }

  template <int dim>
  template <typename Visit>
  StepStatus
  SolidSystem<dim>::for_each_cell(const Vector &u, const Vector &v, const Visit &visit, const double step)
  {
    relevant_u = u;
    if (relevant_v.size() > 0)
      relevant_v = v;
    dealii::Vector<double> f(unknowns.fe.n_dofs_per_cell());
    return for_owned_cells([&](const auto &cell, const Dofs &) {
      motion.a.clear();
      motion.dt               = step;
      const StepStatus status = cell_forces.force(motion, f);
      visit(cell, cell_forces, motion);
      return status;
    });
  }
} // namespace Stroma::Fem
