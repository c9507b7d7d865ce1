#include <stroma/mpm/cell_forces.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>

#include <limits>

namespace Stroma::Mpm
{
  template <int dim>
  CellForces<dim>::CellForces(const Scene<dim> &scene, const Settings<dim> &settings, const BackgroundGrid<dim> &grid,
                              const Points<dim> &points, ActiveCells<dim> &cells)
    : scene(scene)
    , settings(settings)
    , grid(grid)
    , cells(cells)
    , cell_points(scene, points, grid, settings)
  {}

  template <int dim>
  void
  CellForces<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    dealii::DoFTools::make_sparsity_pattern(grid.dofs, pattern, constraints, false,
                                            dealii::Utilities::MPI::this_mpi_process(scene.comm));
  }

  /// Internal forces of the points of a cell, from the stress evaluated last.
  template <int dim>
  void
  CellForces<dim>::sum_forces(const CellPoints<dim> &p)
  {
    if (settings.projected)
      {
        dilatation.begin(p.g_mean);
        for (unsigned int q = 0; q < p.size; ++q)
          {
            dilatation.take(p.V[q], p.tau[q]);
            kernel.add_force(p.V[q], dilatation.deviator(p.tau[q]), p.g[q]);
          }
        for (unsigned int c = 0; c < dim; ++c)
          kernel.add_nodal_force(1., c, dilatation.mean_force(c));
      }
    else
      for (unsigned int q = 0; q < p.size; ++q)
        kernel.add_force(p.V[q], p.tau[q], p.g[q]);
    if (!p.is_viscous)
      return;
    for (const auto &run : p.runs)
      for (unsigned int q = run.begin; q < run.end; ++q)
        {
          const auto stress = p.viscous_stress(q, run.material);
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              kernel.add_nodal_force(p.V[q] * stress[i][k], i, p.g[q][k]);
        }
  }

  /// Their stiffness, of tau and Jc evaluated last.
  template <int dim>
  void
  CellForces<dim>::sum_stiffness(CellPoints<dim> &p, const double v_factor, dealii::FullMatrix<double> &K_cell)
  {
    if (settings.projected)
      {
        dilatation.begin(p.g_mean);
        for (unsigned int q = 0; q < p.size; ++q)
          dilatation.take(p.V[q], p.tau[q]);
        for (unsigned int q = 0; q < p.size; ++q)
          dilatation.split(p.V[q], p.g[q], p.tau[q], p.Jc[q]);
      }
    for (unsigned int q = 0; q < p.size; ++q)
      kernel.add_stiffness(p.V[q], p.tau[q], p.Jc[q], p.g[q]);
    kernel.finish_stiffness();
    kernel.copy_stiffness(K_cell);
    if (settings.projected)
      dilatation.add_stiffness(K_cell);
    if (!p.is_viscous)
      return;
    friction.clear();
    for (const auto &run : p.runs)
      for (unsigned int q = run.begin; q < run.end; ++q)
        friction.add(p.V[q] * p.J[q], scene.media[run.material], p.L[q], v_factor, p.g[q]);
    friction.add_to(K_cell);
  }

  /// Forces of a cell before anything in them cancels: of its modulus, since F = I + grad u is rounded to parts of I, of
  /// displacements and velocities whose differences make gradients, and of the stress. Round-off is a part of that.
  /// @param largest_u largest component of the displacement of its nodes [m] @param largest_v of all that makes their
  /// velocity [m/s]
  template <int dim>
  double
  CellForces<dim>::summed_force(const CellPoints<dim> &p, const double largest_u, const double largest_v) const
  {
    const auto  &sides    = grid.box().cell_size;
    const double gradient = 2. / *std::min_element(sides.begin_raw(),
                                                   sides.end_raw()); // sum over nodes of |grad S|, at most
    double       sum      = 0;
    for (const auto &run : p.runs)
      {
        const double modulus = p.law(run.material).p_wave_modulus() * (1. + gradient * largest_u) +
                               3. * scene.media[run.material].viscosity * gradient * largest_v;
        for (unsigned int q = run.begin; q < run.end; ++q)
          sum += p.V[q] * (modulus + p.tau[q].norm());
      }
    return gradient * sum;
  }

  template <int dim>
  StepStatus
  CellForces<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    energy = squares  = 0.;
    StepStatus status = StepStatus::ok;
    cells.add_nodal(r, [&](std::vector<double> &nodal) {
      status = for_each_cell(motion, stage, [&](const ActiveCell<dim> &active, CellPoints<dim> &p, const auto &u) {
        const StepStatus evaluated = p.evaluate(Materials::energy);
        if (evaluated != StepStatus::ok)
          return evaluated;
        kernel.clear();
        sum_forces(p);
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int c = 0; c < dim; ++c)
            nodal[active.node[a] + c] -= kernel.force_at(a, c);
        for (unsigned int q = 0; q < p.size; ++q)
          energy += p.V[q] * p.psi[q];
        const double largest_u = Solid::largest<dim>(u);
        double       largest_v = 0;
        if (p.is_viscous) // v = factor u + known, which may cancel
          largest_v = Solid::largest<dim>(cells.at_nodes(active, motion.v)) + 2. * stage.v_factor * largest_u;
        squares += std::pow(summed_force(p, largest_u, largest_v), 2);
        return StepStatus::ok;
      });
    });
    return status;
  }

  template <int dim>
  StepStatus
  CellForces<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                               const Solvers::Constraints &constraints)
  {
    typename ActiveCells<dim>::Assembly assembly(cells, K, r, constraints);
    dealii::FullMatrix<double>          K_cell(dim * n_nodes);
    return for_each_cell(motion, stage, [&](const ActiveCell<dim> &active, CellPoints<dim> &p, const auto &) {
      const StepStatus evaluated = p.evaluate(Materials::tangent);
      if (evaluated != StepStatus::ok)
        return evaluated;
      kernel.clear();
      sum_stiffness(p, stage.v_factor, K_cell);
      assembly.add(active, K_cell);
      return StepStatus::ok;
    });
  }

  template <int dim>
  void
  CellForces<dim>::commit(const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    if (cell_points.n_history() == 0)
      return;
    for_each_cell(motion, stage, [](const ActiveCell<dim> &, CellPoints<dim> &p, const auto &) {
      const StepStatus evaluated = p.evaluate(Materials::next_step);
      p.keep_history();
      return evaluated;
    });
  }

  template <int dim>
  double
  CellForces<dim>::round_off() const
  {
    return std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template <int dim>
  double
  CellForces<dim>::strain_energy() const
  {
    return dealii::Utilities::MPI::sum(energy, scene.comm);
  }

  template class CellForces<2>;
  template class CellForces<3>;
} // namespace Stroma::Mpm
