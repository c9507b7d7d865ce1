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
    , cell_points(points, grid, settings, scene.materials.size())
  {}

  template <int dim>
  void
  CellForces<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    dealii::DoFTools::make_sparsity_pattern(grid.dofs, pattern, constraints, false,
                                            dealii::Utilities::MPI::this_mpi_process(scene.comm));
  }

  template <int dim>
  StepStatus
  CellForces<dim>::evaluate_stress(const CellPoints<dim> &p)
  {
    if (tau.size() < p.size)
      tau.resize(p.size);
    if (psi.size() < p.size)
      psi.resize(p.size);
    StepStatus status = StepStatus::ok;
    for (const auto &run : p.runs)
      {
        const unsigned int n = run.end - run.begin;
        status = worse(status, scene.materials[run.material]->evaluate({{p.F.data() + run.begin, n}, {}},
                                                                       {{tau.data() + run.begin, n},
                                                                        {},
                                                                        {psi.data() + run.begin, n},
                                                                        {},
                                                                        {}}));
      }
    for (unsigned int q = 0; q < p.size; ++q)
      energy += p.V[q] * psi[q];
    return status;
  }

  template <int dim>
  StepStatus
  CellForces<dim>::evaluate_tangent(const CellPoints<dim> &p)
  {
    if (tau.size() < p.size)
      tau.resize(p.size);
    if (Jc.size() < p.size)
      Jc.resize(p.size);
    StepStatus status = StepStatus::ok;
    for (const auto &run : p.runs)
      {
        const unsigned int n = run.end - run.begin;
        status = worse(status, scene.materials[run.material]->evaluate({{p.F.data() + run.begin, n}, {}},
                                                                       {{tau.data() + run.begin, n},
                                                                        {Jc.data() + run.begin, n},
                                                                        {},
                                                                        {},
                                                                        {}}));
      }
    return status;
  }

  /// Internal forces of the points of a cell, from the stress evaluated last.
  template <int dim>
  void
  CellForces<dim>::sum_forces(const CellPoints<dim> &p)
  {
    if (!settings.projected)
      {
        for (unsigned int q = 0; q < p.size; ++q)
          kernel.add_force(p.V[q], tau[q], p.g[q]);
        return;
      }
    dilatation.begin(p.g_mean);
    for (unsigned int q = 0; q < p.size; ++q)
      {
        dilatation.take(p.V[q], tau[q]);
        kernel.add_force(p.V[q], dilatation.deviator(tau[q]), p.g[q]);
      }
    for (unsigned int c = 0; c < dim; ++c)
      kernel.add_nodal_force(1., c, dilatation.mean_force(c));
  }

  /// The same for the stiffness.
  template <int dim>
  void
  CellForces<dim>::sum_stiffness(const CellPoints<dim> &p)
  {
    if (settings.projected)
      {
        dilatation.begin(p.g_mean);
        for (unsigned int q = 0; q < p.size; ++q)
          dilatation.take(p.V[q], tau[q]);
        for (unsigned int q = 0; q < p.size; ++q)
          dilatation.split(p.V[q], p.g[q], tau[q], Jc[q]);
      }
    for (unsigned int q = 0; q < p.size; ++q)
      kernel.add_stiffness(p.V[q], tau[q], Jc[q], p.g[q]);
    kernel.finish_stiffness();
  }

  /// Forces of a cell before anything in them cancels: of its modulus, since F = I + grad u is rounded to parts of I, of
  /// displacements whose differences make grad u, and of the stress. Round-off is a part of that.
  /// @param largest_u largest component of the displacement of its nodes [m]
  template <int dim>
  double
  CellForces<dim>::summed_force(const CellPoints<dim> &p, const double largest_u) const
  {
    const auto  &sides    = grid.box().cell_size;
    const double gradient = 2. / *std::min_element(sides.begin_raw(), sides.end_raw()); // sum over nodes of |grad S|, at most
    double       sum      = 0;
    for (const auto &run : p.runs)
      {
        const double modulus = scene.materials[run.material]->p_wave_modulus() * (1. + gradient * largest_u);
        for (unsigned int q = run.begin; q < run.end; ++q)
          sum += p.V[q] * (modulus + tau[q].norm());
      }
    return gradient * sum;
  }

  template <int dim>
  StepStatus
  CellForces<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &)
  {
    energy = squares  = 0.;
    StepStatus status = StepStatus::ok;
    cells.add_nodal(r, [&](std::vector<double> &nodal) {
      status = for_each_cell(motion, [&](const ActiveCell<dim> &active, const CellPoints<dim> &p, const auto &u) {
        const StepStatus evaluated = evaluate_stress(p);
        if (evaluated != StepStatus::ok)
          return evaluated;
        kernel.clear();
        sum_forces(p);
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int c = 0; c < dim; ++c)
            nodal[active.node[a] + c] -= kernel.force_at(a, c);
        squares += std::pow(summed_force(p, Solid::largest<dim>(u)), 2);
        return StepStatus::ok;
      });
    });
    return status;
  }

  template <int dim>
  StepStatus
  CellForces<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &,
                               const Solvers::Constraints &constraints)
  {
    typename ActiveCells<dim>::Assembly assembly(cells, K, r, constraints);
    dealii::FullMatrix<double>          K_cell(dim * n_nodes);
    return for_each_cell(motion, [&](const ActiveCell<dim> &active, const CellPoints<dim> &p, const auto &) {
      const StepStatus evaluated = evaluate_tangent(p);
      if (evaluated != StepStatus::ok)
        return evaluated;
      kernel.clear();
      sum_stiffness(p);
      kernel.copy_stiffness(K_cell);
      if (settings.projected)
        dilatation.add_stiffness(K_cell);
      assembly.add(active, K_cell);
      return StepStatus::ok;
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
