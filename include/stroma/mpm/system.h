#pragma once

#include <stroma/base/log.h>
#include <stroma/grid/free_parts.h>
#include <stroma/mpm/cell_points.h>
#include <stroma/mpm/prescribed.h>
#include <stroma/solid/projected_dilatation.h>
#include <stroma/solvers/grid_system.h>

#include <deal.II/lac/full_matrix.h>

namespace Stroma::Mpm
{
  /**
   * The equations of one MPM step on the background grid: f_ext - f_int(u) = 0 (7), with u the grid displacement since
   * the last rebase (reset of the grid, or, with published forces, every step).
   */
  template <int dim>
  class System : public Solvers::GridSystem
  {
  public:
    System(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid, Points<dim> &points,
           PrescribedMotion<dim> &motion, Timers &timers);

    /// Unknowns, held nodes, vectors and matrix pattern for the cells that hold points now. Collective.
    void rebuild();

    /// Targets of supports and loads at time @p t; @p t_rebase is the time of the last rebase. Collective.
    void set_time(double t, double t_rebase);

    StepStatus residual(Vector &r, const Vector &u) override;
    StepStatus tangent(Matrix &K, Vector &r, const Vector &u) override;
    double     force_scale() const override { return internal_force_norm; }
    double     round_off() const override { return round_off_norm; }

    /// Makes @p K fit the present unknowns.
    void reinit_matrix(Matrix &K) const;
    /// A zero vector over the owned unknowns.
    Vector new_vector() const;

    /// Total force by which each support holds the body, [support][component], from the last residual() [N]. Collective.
    std::vector<dealii::Tensor<1, dim>> reactions() const;

    /// Strain energy at the last residual() [J]. Collective.
    double strain_energy() const;

    /// Largest distance of a driven point from its target at the last residual() [m]. Collective.
    double largest_driven_gap() const;

    /// f_ext - f_int on all unknowns from the last residual(): on held ones, minus the reaction.
    const Vector &unbalanced_forces() const { return unbalanced; }

    /// Calls @p visit(cell, points, u of its nodes, node positions in the relevant set) for each owned cell with points,
    /// under grid displacement @p u; the worst status of the gathering on this rank is returned.
    template <typename Visit>
    StepStatus for_each_cell(const Vector &u, const Visit &visit);

    /// Moves the step's deformation from the grid to the points: F^r <- F_D F^r, displacement; locations too if asked.
    void rebase_points(const Vector &u, bool move_locations);

    /// Whether every point stays on the grid when moved by @p u. Collective.
    bool stays_on_grid(const Vector &u);

    /// Largest Frobenius norm of the Green-Lagrange strain since the last rebase. Collective.
    double distortion(const Vector &u);

    /// The parts that nothing holds, among those that the cells with points fall into. Throws UserError if loads drive
    /// them between 0 and @p end_time [s]. Collective.
    FreeParts<dim> free_parts(const ConnectedParts<dim> &parts, double end_time) const;

    /// The smallest share of its volume that material takes up, by the deformation at the last rebase, of all cells whose
    /// neighbours all hold points; 1 if there is no such cell. Collective.
    double emptiest_inner_cell() const;

    /// Rigid-body motions on the free unknowns, the near null space of the stiffness.
    std::vector<Vector> rigid_motions() const;

    /// The system's vectors and whether they are allocated, for the summary.
    std::vector<std::pair<std::string, bool>> vectors() const
    {
      return {{"unbalanced force", unbalanced.size() > 0},
              {"external force", external.size() > 0},
              {"displacement with ghosts", relevant_u.size() > 0}};
    }

    unsigned long long n_unknowns() const { return grid.dofs.n_dofs(); }

  private:
    using L     = Solid::Lanes<dim>;
    using Cell  = typename dealii::DoFHandler<dim>::active_cell_iterator;
    static constexpr unsigned int n_nodes = 1u << dim;

    void       list_cells();
    void       assemble_loads(double t);
    void       find_loads();
    /// Calls visit(active cell, point, force on it) for the points of this rank at time @p t.
    template <typename Visit>
    void       for_each_load(double t, const Visit &visit) const;
    void       add_forces(const CellPoints<dim> &points);
    void       add_stiffness(const CellPoints<dim> &points);
    StepStatus evaluate_stress(const CellPoints<dim> &points);
    StepStatus evaluate_tangent(const CellPoints<dim> &points);
    dealii::Tensor<1, dim> driven_gap(const CellPoints<dim> &cell_points, unsigned int p, unsigned int support,
                                      const std::array<L, dim> &u) const;
    double     smallest_side() const;
    double     spring(const CellPoints<dim> &cell_points, unsigned int p, unsigned int material) const;
    void       find_round_off(double squares);
    double     summed_force(const CellPoints<dim> &cell_points, double largest_u) const;
    template <typename Act>
    void       for_driven(const CellPoints<dim> &cell_points, const std::array<L, dim> &u, const Act &act) const;

    const Scene<dim>      &scene;
    const Settings<dim>   &settings;
    BackgroundGrid<dim>   &grid;
    Points<dim>           &points;
    PrescribedMotion<dim> &motion;
    Timers                &timers;
    MPI_Comm               comm;

    struct ActiveCell
    {
      Cell                      cell;
      bool                      is_held; ///< has a held unknown
      std::array<int, n_nodes>  node;    ///< position of the node's first unknown in the relevant set
    };
    std::vector<ActiveCell> cells; ///< owned cells that hold points

    Vector                                           unbalanced, external; // external only with loads
    Vector                                           relevant_u;
    std::vector<double>                              relevant_force;
    std::vector<dealii::types::global_dof_index>     relevant_index;
    std::vector<double>                              held_target;   ///< of motion.held(), relative to the last rebase [m]
    double                                           time = 0., internal_force_norm = 0., round_off_norm = 0.;
    std::vector<double>                              load_volume;   ///< of each load's region [m^3]
    std::vector<long long>                           load_point;    ///< id of the nearest point, or -1
    std::vector<dealii::Tensor<1, dim>>              driven_reaction; ///< by support, this rank, last residual()
    double                                           energy = 0., driven_gap_norm = 0.; ///< this rank, last residual()

    CellPoints<dim>                          cell_points;
    Solid::MomentumKernel<dim>               kernel;
    Solid::ProjectedDilatation<dim>          dilatation; ///< only used if it is projected
    std::vector<dealii::SymmetricTensor<2, 3>> tau;
    std::vector<dealii::SymmetricTensor<4, 3>> Jc;
    std::vector<double>                        psi;
  };

  template <int dim>
  template <typename Visit>
  StepStatus
  System<dim>::for_each_cell(const Vector &u, const Visit &visit)
  {
    relevant_u               = u;
    const double *values     = relevant_u.begin();
    StepStatus    status     = StepStatus::ok;
    for (const auto &active : cells)
      {
        std::array<L, dim> u_cell;
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int a = 0; a < n_nodes; ++a)
            u_cell[c][a] = values[active.node[a] + c];
        const StepStatus gathered = cell_points.gather(active.cell, u_cell);
        status                    = worse(status, gathered);
        if (gathered == StepStatus::ok)
          status = worse(status, visit(active, cell_points, u_cell));
        if (status != StepStatus::ok)
          break;
      }
    return status;
  }
} // namespace Stroma::Mpm
