#pragma once

#include <stroma/mpm/active_cells.h>
#include <stroma/mpm/cell_points.h>
#include <stroma/solid/projected_dilatation.h>
#include <stroma/solid/viscous_stiffness.h>

namespace Stroma::Mpm
{
  /// Internal forces, f_int of (7), cell by cell from the points of each, with the viscous stress of their materials.
  template <int dim>
  class CellForces : public Solvers::Term
  {
  public:
    CellForces(const Scene<dim> &scene, const Settings<dim> &settings, const BackgroundGrid<dim> &grid,
               const Points<dim> &points, ActiveCells<dim> &cells);

    void       add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const override;
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    bool
    symmetric() const override
    {
      return !cell_points.is_viscous;
    }
    double round_off() const override;
    /// Stores at the points what laws with history remember.
    void commit(const Solvers::Motion &motion, const Solvers::Stage &stage) override;

    /// Strain energy at the last add_force() [J]. Collective.
    double strain_energy() const;

    /// Calls @p visit(cell, points, u of its nodes) for each owned cell with points, under the motion @p motion; the worst
    /// status on this rank is returned.
    template <typename Visit>
    StepStatus for_each_cell(const Solvers::Motion &motion, const Solvers::Stage &stage, const Visit &visit);

  private:
    using L                               = Solid::Lanes<dim>;
    static constexpr unsigned int n_nodes = 1u << dim;

    void   sum_forces(const CellPoints<dim> &points);
    void   sum_stiffness(CellPoints<dim> &points, double v_factor, dealii::FullMatrix<double> &K_cell);
    double summed_force(const CellPoints<dim> &points, double largest_u, double largest_v) const;

    const Scene<dim>          &scene;
    const Settings<dim>       &settings;
    const BackgroundGrid<dim> &grid;
    ActiveCells<dim>          &cells;
    double                     energy = 0., squares = 0.; ///< this rank, last add_force()

    CellPoints<dim>                 cell_points;
    Solid::MomentumKernel<dim>      kernel;
    Solid::ProjectedDilatation<dim> dilatation; ///< only used if it is projected
    Solid::ViscousStiffness<dim>    friction;   ///< only of viscous scenes
  };

  template <int dim>
  template <typename Visit>
  StepStatus
  CellForces<dim>::for_each_cell(const Solvers::Motion &motion, const Solvers::Stage &stage, const Visit &visit)
  {
    const bool moves  = cell_points.is_viscous && (stage.v_factor > 0. || stage.v_known.size() > 0);
    StepStatus status = StepStatus::ok;
    cell_points.dt    = stage.dt;
    for (const auto &active : cells)
      {
        const auto u = cells.at_nodes(active, motion.u);
        if (moves)
          {
            const auto v = cells.at_nodes(active, motion.v);
            status       = cell_points.gather(active.cell, u, &v);
          }
        else
          status = cell_points.gather(active.cell, u);
        if (status == StepStatus::ok)
          status = visit(active, cell_points, u);
        if (status != StepStatus::ok)
          break;
      }
    return status;
  }
} // namespace Stroma::Mpm
