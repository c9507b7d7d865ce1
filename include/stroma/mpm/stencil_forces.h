#pragma once

#include <stroma/base/power.h>
#include <stroma/mpm/cell_forces.h>
#include <stroma/mpm/cell_points.h>
#include <stroma/solid/projected_dilatation.h>
#include <stroma/solid/viscous_stiffness.h>

namespace Stroma::Mpm
{
  /// Internal forces for shape functions with n nodes a cell.
  template <int dim, unsigned int n>
  class StencilForces : public CellForces<dim>
  {
  public:
    StencilForces(const Scene<dim> &scene, const Settings<dim> &settings, const BackgroundGrid<dim> &grid,
                  const Points<dim> &points, ActiveCells<dim> &cells);

    void       rebuild() override;
    void       add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const override;
    StepStatus add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                           const Solvers::Constraints &constraints) override;
    bool
    symmetric() const override
    {
      return points.has_symmetric_tangents() && !points.is_viscous;
    }
    bool
    acts_in_cells_only() const override
    {
      return n == power(2, dim) && symmetric();
    }
    double round_off() const override;
    /// Stores at the points what laws with history remember.
    void commit(const Solvers::Motion &motion, const Solvers::Stage &stage) override;

    double strain_energy() const override;
    const std::vector<unsigned int> &
    kinds() const override
    {
      return points.kinds();
    }
    StepStatus for_each_kind(const Solvers::Motion &motion, const Solvers::Stage &stage,
                             const typename CellForces<dim>::VisitKind &visit) override;
    StepStatus for_each_stiffness(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                  const typename CellForces<dim>::VisitStiffness &visit) override;
    StepStatus for_each_cell(const Solvers::Motion &motion, const Solvers::Stage &stage,
                             const typename CellForces<dim>::Visit &visit) override;
    StepStatus check_all_points(const Solvers::Motion &motion, const Solvers::Stage &stage) override;
    StepStatus for_each_jump(const Solvers::Motion &motion, const Solvers::Stage &stage,
                             const typename CellForces<dim>::VisitJumps &visit) override;

  private:
    static bool
    any(const ActiveCell<dim> &)
    {
      return true;
    }

    /// for_each_cell() with the points for n nodes: those of the solve, or all; of the cells that are wanted.
    template <typename VisitPoints, typename Wanted = bool (*)(const ActiveCell<dim> &)>
    StepStatus for_cells(const Solvers::Motion &motion, const Solvers::Stage &stage, Gathered which,
                         const VisitPoints &visit, const Wanted &is_wanted = any);

    StepStatus find_stiffness(CellPoints<dim, n> &p, const Solvers::Stage &stage, dealii::FullMatrix<double> &K_cell);
    std::vector<dealii::Tensor<2, dim>> mean_gradients(const Solvers::Motion &motion) const;
    typename CellPoints<dim, n>::Nodal  uniform(const dealii::Tensor<2, dim> &gradient) const;

    void   sum_forces();
    void   sum_stiffness(double v_factor, dealii::FullMatrix<double> &K_cell);
    double summed_force(double largest_u, double largest_v) const;

    const Scene<dim>          &scene;
    const Settings<dim>       &settings;
    const BackgroundGrid<dim> &grid;
    ActiveCells<dim>          &cells;
    double                     energy = 0., squares = 0.; ///< this rank, last add_force()

    CellPoints<dim, n>                 points;
    Solid::MomentumKernel<dim, n>      kernel;
    Solid::ProjectedDilatation<dim, n> dilatation; ///< only used if it is projected
    Solid::ViscousStiffness<dim, n>    friction;   ///< only of viscous scenes
  };
} // namespace Stroma::Mpm
