#pragma once

#include <stroma/mpm/active_cells.h>
#include <stroma/mpm/cell_points.h>
#include <stroma/solid/projected_dilatation.h>

namespace Stroma::Mpm
{
  /// Internal forces, f_int of (7), cell by cell from the points of each.
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
    double     round_off() const override;

    /// Strain energy at the last add_force() [J]. Collective.
    double strain_energy() const;

    /// Calls @p visit(cell, points, u of its nodes) for each owned cell with points, under the motion @p motion; the worst
    /// status on this rank is returned.
    template <typename Visit>
    StepStatus for_each_cell(const Solvers::Motion &motion, const Visit &visit);

  private:
    using L                               = Solid::Lanes<dim>;
    static constexpr unsigned int n_nodes = 1u << dim;

    StepStatus evaluate_stress(const CellPoints<dim> &points);
    StepStatus evaluate_tangent(const CellPoints<dim> &points);
    void       sum_forces(const CellPoints<dim> &points);
    void       sum_stiffness(const CellPoints<dim> &points);
    double     summed_force(const CellPoints<dim> &points, double largest_u) const;

    const Scene<dim>          &scene;
    const Settings<dim>       &settings;
    const BackgroundGrid<dim> &grid;
    ActiveCells<dim>          &cells;
    double                     energy = 0., squares = 0.; ///< this rank, last add_force()

    CellPoints<dim>                            cell_points;
    Solid::MomentumKernel<dim>                 kernel;
    Solid::ProjectedDilatation<dim>            dilatation; ///< only used if it is projected
    std::vector<dealii::SymmetricTensor<2, 3>> tau;
    std::vector<dealii::SymmetricTensor<4, 3>> Jc;
    std::vector<double>                        psi;
  };

  template <int dim>
  template <typename Visit>
  StepStatus
  CellForces<dim>::for_each_cell(const Solvers::Motion &motion, const Visit &visit)
  {
    StepStatus status = StepStatus::ok;
    for (const auto &active : cells)
      {
        const auto u = cells.at_nodes(active, motion.u);
        status       = cell_points.gather(active.cell, u);
        if (status == StepStatus::ok)
          status = visit(active, cell_points, u);
        if (status != StepStatus::ok)
          break;
      }
    return status;
  }
} // namespace Stroma::Mpm
