#pragma once

#include <stroma/grid/free_parts.h>
#include <stroma/mpm/cell_forces.h>
#include <stroma/mpm/cell_tangent.h>
#include <stroma/mpm/driven_points.h>
#include <stroma/mpm/loads.h>
#include <stroma/mpm/prescribed.h>
#include <stroma/mpm/rigid_surfaces.h>
#include <stroma/rigid/contact_term.h>
#include <stroma/rigid/turning_term.h>
#include <stroma/solvers/sum_of_terms.h>

namespace Stroma::Mpm
{
  /**
   * The equations of one MPM step on the background grid: f_ext - f_int(u) + f_driven(u) + f_rigid(u) = 0 (7), with u the grid
   * displacement since the last rebase (reset of the grid, or, with published forces, every step) and, after it, the unknowns
   * of rigid bodies.
   */
  template <int dim>
  class System : public Solvers::SumOfTerms
  {
  public:
    System(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid, Points<dim> &points,
           PrescribedMotion<dim> &prescribed, Timers &timers);

    /// Whether all that acts are internal forces of cells with linear shape functions, symmetric.
    bool acts_in_cells_only() const;

    /// From now on the tangent is kept as matrices of cells with multigrid of its own, where acts_in_cells_only(). Collective.
    void keep_tangent();

    /// From now on it is assembled again.
    void
    assemble_tangent()
    {
      cell_tangent.reset();
    }

    StepStatus tangent(Matrix &K, Vector &r, const Vector &u) override;
    Solvers::Operator *
    kept_tangent() override
    {
      return cell_tangent.get();
    }

    /// Unknowns, held nodes and vectors for the cells that hold points now. Collective.
    void rebuild();

    /// Targets of supports and loads in a stage of a step; @p t_rebase is the time of the last rebase. Collective.
    void set_stage(const Solvers::Stage &stage, double t_rebase);

    /// Ends the last stage: what follows is asked of the committed state with the grid velocity @p v, see set_committed().
    void end_step(const Vector &v);

    /// The stage of a committed state at time @p t with the grid velocity @p v (empty: the points keep their velocity
    /// gradients, or the scene has none). Collective.
    void set_committed(double t, double t_rebase, const Vector &v = Vector());

    /// Total force by which each support holds the body, [support][component], from the last residual() [N]. Collective.
    std::vector<dealii::Tensor<1, dim>> reactions() const;

    /// Motion of the rigid bodies at @p u, forces and torques from the last residual(); their contacts. Collective.
    std::vector<std::pair<std::string, double>> rigid_results(const Vector &u);

    /// Strain energy at the last residual() [J]. Collective.
    double
    strain_energy() const
    {
      return cell_forces->strain_energy();
    }

    /// Largest distance of a driven point from its target at the last residual() [m]. Collective.
    double
    largest_driven_gap() const
    {
      return driven.largest_gap();
    }

    /// Calls @p visit(cell, points) for each owned cell with points, under grid displacement @p u, with velocities as the
    /// stage says; the worst status on this rank is returned. Collective.
    StepStatus
    for_each_cell(const Vector &u, const typename CellForces<dim>::Visit &visit)
    {
      find_motion(u);
      return cell_forces->for_each_cell(motion, stage, visit);
    }

    /// CellForces::check_all_points() under the unknowns @p u. Collective.
    StepStatus
    check_all_points(const Vector &u)
    {
      find_motion(u);
      return cell_forces->check_all_points(motion, stage);
    }

    /// CellForces::for_each_jump() under the unknowns @p u.
    StepStatus
    for_each_jump(const Vector &u, const typename CellForces<dim>::VisitJumps &visit)
    {
      motion.u = u;
      return cell_forces->for_each_jump(motion, stage, visit);
    }

    /// Moves the step's deformation from the grid to the points: F^r <- F_D F^r, displacement; locations too if asked.
    void rebase_points(const Vector &u, bool move_locations);

    /// Whether every point stays on the grid when moved by @p u. Collective.
    bool stays_on_grid(const Vector &u);

    /// Largest Frobenius norm of the Green-Lagrange strain since the last rebase. Collective.
    double distortion(const Vector &u);

    /// The parts that nothing holds, among those that the cells with points fall into. Throws UserError if loads drive
    /// them between 0 and @p end_time [s]. Collective.
    FreeParts<dim> free_parts(const ConnectedParts<dim> &parts, double end_time) const;

    /// How far the deformation gradients of the points are from their places under @p u: of the distances x_p - x_c from the
    /// centre of the points of a cell, the root mean square share that the trapezoids of F to those points do not explain,
    ///   x_p - x_q = (F_p + F_q) (X_p - X_q) / 2.
    /// Zero for quadratic motions; what resets leave grows there before forces are wrong. Collective.
    double misfit(const Vector &u);

    /// The smallest share of its volume that material takes up, by the deformation at the last rebase, of all cells whose
    /// neighbours all hold points; 1 if there is no such cell. Collective.
    double emptiest_inner_cell() const;

    /// Rigid-body motions on the free unknowns, the near null space of the stiffness.
    std::vector<Vector> rigid_motions() const;

    unsigned long long
    n_unknowns() const
    {
      return owned.size();
    }

    /// The part of @p u (owned unknowns) that belongs to the grid.
    Vector on_grid(const Vector &u) const;

    Rigid::Unknowns<dim>    bodies; ///< the scene's rigid ones; their unknowns follow those of the grid
    Rigid::ContactTerm<dim> touching;

  private:
    Solvers::Constraints constraints(const std::vector<double> &jump) const override;
    void
    add_pattern(Solvers::Pattern &pattern) const override
    {
      bodies.add_pattern(pattern);
    }
    void fill_empty_rows(Matrix &K, Vector &r, const Solvers::Constraints &constraints) const override;

    void check_loads(FreeParts<dim> &free, const ConnectedParts<dim> &parts, double end_time) const;

    const Scene<dim>                 &scene;
    const Settings<dim>              &settings;
    BackgroundGrid<dim>              &grid;
    Points<dim>                      &points;
    PrescribedMotion<dim>            &prescribed;
    ActiveCells<dim>                  cells;
    Loads<dim>                        loads;
    std::unique_ptr<CellForces<dim>>  cell_forces;
    std::unique_ptr<CellTangent<dim>> cell_tangent; ///< where it is kept
    DrivenPoints<dim>                 driven;
    RigidSurfaces<dim>                surfaces;
    Rigid::TurningTerm<dim>           turning;
  };
} // namespace Stroma::Mpm
