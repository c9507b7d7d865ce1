#include <stroma/base/power.h>
#include <stroma/mpm/stencil_forces.h>

#include <deal.II/base/mpi.h>

#include <limits>

namespace Stroma::Mpm
{
  template <int dim, unsigned int n>
  StencilForces<dim, n>::StencilForces(const Scene<dim> &scene, const Settings<dim> &settings,
                                       const BackgroundGrid<dim> &grid, const Points<dim> &points,
                                       ActiveCells<dim> &cells)
    : scene(scene)
    , settings(settings)
    , grid(grid)
    , cells(cells)
    , points(scene, points, grid, settings)
  {}

  template <int dim, unsigned int n>
  void
  StencilForces<dim, n>::rebuild()
  {
    points.rebuild(grid);
  }

  template <int dim, unsigned int n>
  void
  StencilForces<dim, n>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    cells.add_pattern(pattern, constraints);
  }

  template <int dim, unsigned int n>
  template <typename VisitPoints, typename Wanted>
  StepStatus
  StencilForces<dim, n>::for_cells(const Solvers::Motion &motion, const Solvers::Stage &stage, const Gathered which,
                                   const VisitPoints &visit, const Wanted &is_wanted)
  {
    const bool moves  = points.is_viscous && (stage.v_factor > 0. || stage.v_known.size() > 0);
    StepStatus status = StepStatus::ok;
    points.dt         = stage.dt;
    for (const auto &active : cells)
      {
        if (!is_wanted(active))
          continue;
        const auto u = cells.template at_nodes<n>(active, motion.u);
        if (moves)
          {
            const auto v = cells.template at_nodes<n>(active, motion.v);
            status       = points.gather(active, which, u, &v);
          }
        else
          status = points.gather(active, which, u);
        if (status == StepStatus::ok)
          status = visit(active, points);
        if (status != StepStatus::ok)
          break;
      }
    return status;
  }

  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::for_each_cell(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                       const typename CellForces<dim>::Visit &visit)
  {
    return for_cells(motion, stage, Gathered::all_points, visit);
  }

  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::check_all_points(const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    return for_cells(motion, stage, Gathered::for_solve, [&](const ActiveCell<dim> &active, auto &p) {
      return p.no_place_is_inverted() ? StepStatus::ok :
                                        p.gather(active, Gathered::all_points, typename CellPoints<dim, n>::Nodal(p.u));
    });
  }

  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::for_each_jump(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                       const typename CellForces<dim>::VisitJumps &visit)
  {
    return for_cells(motion, stage, Gathered::for_solve, [&](const ActiveCell<dim> &active, const auto &p) {
      if (p.has_interface())
        visit(active, p.jumps());
      return StepStatus::ok;
    });
  }

  /// Internal forces of the points of a cell, from the stress evaluated last.
  template <int dim, unsigned int n>
  void
  StencilForces<dim, n>::sum_forces()
  {
    const auto &p = points;
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
  template <int dim, unsigned int n>
  void
  StencilForces<dim, n>::sum_stiffness(const double v_factor, dealii::FullMatrix<double> &K_cell)
  {
    auto &p = points;
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
    p.condense_jump(K_cell);
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
  template <int dim, unsigned int n>
  double
  StencilForces<dim, n>::summed_force(const double largest_u, const double largest_v) const
  {
    const auto &p     = points;
    const auto &sides = grid.box().cell_size;
    // Sum over nodes of |grad S|, at most; of B-splines in the cells at the grid's ends.
    const double gradient = (grid.shape->interpolates() ? 2. : 4.) /
                            *std::min_element(sides.begin_raw(), sides.end_raw());
    double sum = 0;
    for (const auto &run : p.runs)
      {
        const double modulus = p.law(run.material).p_wave_modulus() * (1. + gradient * largest_u) +
                               3. * scene.media[run.material].viscosity * gradient * largest_v;
        for (unsigned int q = run.begin; q < run.end; ++q)
          sum += p.V[q] * (modulus + p.tau[q].norm());
      }
    return gradient * sum;
  }

  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    energy = squares  = 0.;
    StepStatus status = StepStatus::ok;
    cells.add_nodal(r, [&](std::vector<double> &nodal) {
      status = for_cells(motion, stage, Gathered::for_solve, [&](const ActiveCell<dim> &active, auto &p) {
        const StepStatus evaluated = p.evaluate(Materials::energy);
        if (evaluated != StepStatus::ok)
          return evaluated;
        kernel.clear();
        sum_forces();
        for (unsigned int a = 0; a < n; ++a)
          for (unsigned int c = 0; c < dim; ++c)
            nodal[active.node[a] + c] -= kernel.force_at(a, c);
        for (unsigned int q = 0; q < p.size; ++q)
          energy += p.V[q] * p.psi[q];
        const double largest_u = largest<n>(p.u);
        double       largest_v = 0;
        if (p.is_viscous) // v = factor u + known, which may cancel
          largest_v = largest<n>(cells.template at_nodes<n>(active, motion.v)) + 2. * stage.v_factor * largest_u;
        squares += std::pow(summed_force(largest_u, largest_v), 2);
        return StepStatus::ok;
      });
    });
    return status;
  }

  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage,
                                     const Solvers::Constraints &constraints)
  {
    AssertThrow(kinds().empty(), dealii::ExcMessage("A shared stiffness is never assembled."));
    typename ActiveCells<dim>::Assembly assembly(cells, K, r, constraints);
    return for_each_stiffness(motion, stage,
                              [&](const ActiveCell<dim> &active, const dealii::FullMatrix<double> &K_cell) {
                                assembly.add(active, K_cell);
                              });
  }

  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::for_each_stiffness(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                            const typename CellForces<dim>::VisitStiffness &visit)
  {
    dealii::FullMatrix<double> K_cell(dim * n);
    const auto                 is_of_no_kind = [&](const ActiveCell<dim> &active) {
      return kinds().empty() || kinds()[active.number] == TwoMomentPoints<dim>::no_kind;
    };
    return for_cells(
      motion, stage, Gathered::for_solve,
      [&](const ActiveCell<dim> &active, auto &p) {
        const StepStatus status = find_stiffness(p, stage, K_cell);
        if (status == StepStatus::ok)
          visit(active, K_cell);
        return status;
      },
      is_of_no_kind);
  }

  /// Of the points that were gathered.
  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::find_stiffness(CellPoints<dim, n> &p, const Solvers::Stage &stage,
                                        dealii::FullMatrix<double> &K_cell)
  {
    const StepStatus evaluated = p.evaluate(Materials::tangent);
    if (evaluated != StepStatus::ok)
      return evaluated;
    kernel.clear();
    sum_stiffness(stage.v_factor, K_cell);
    return StepStatus::ok;
  }

  /// grad u of linear functions, by material, over all cells that have a kind. Collective.
  template <int dim, unsigned int n>
  std::vector<dealii::Tensor<2, dim>>
  StencilForces<dim, n>::mean_gradients(const Solvers::Motion &motion) const
  {
    constexpr unsigned int size = 1 + dim * dim;
    std::vector<double>    sums(size * scene.materials.size());
    const auto             h = grid.box().cell_size;
    for (const auto &active : cells)
      if (const unsigned int kind = kinds()[active.number]; kind != TwoMomentPoints<dim>::no_kind)
        {
          double *const sum = &sums[size * points.material_of_kind(kind)];
          const auto    u   = cells.template at_nodes<n>(active, motion.u);
          sum[0] += 1.;
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int a = 0; a < n; ++a)
                sum[1 + i * dim + d] += (a >> d & 1 ? 2. : -2.) * u[i][a] / (n * h[d]);
        }
    dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    std::vector<dealii::Tensor<2, dim>> means(scene.materials.size());
    for (unsigned int m = 0; m < means.size(); ++m)
      for (unsigned int i = 0; i < dim && sums[size * m] > 0.; ++i)
        for (unsigned int d = 0; d < dim; ++d)
          means[m][i][d] = sums[size * m + 1 + i * dim + d] / sums[size * m];
    return means;
  }

  /// Displacement of a cell's nodes with this gradient.
  template <int dim, unsigned int n>
  typename CellPoints<dim, n>::Nodal
  StencilForces<dim, n>::uniform(const dealii::Tensor<2, dim> &gradient) const
  {
    typename CellPoints<dim, n>::Nodal u{};
    const auto                         h = grid.box().cell_size;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int a = 0; a < n; ++a)
        for (unsigned int d = 0; d < dim; ++d)
          u[i][a] += (a >> d & 1 ? 1. : 0.) * gradient[i][d] * h[d];
    return u;
  }

  template <int dim, unsigned int n>
  StepStatus
  StencilForces<dim, n>::for_each_kind(const Solvers::Motion &motion, const Solvers::Stage &stage,
                                       const typename CellForces<dim>::VisitKind &visit)
  {
    if (!settings.shares_stiffness)
      return StepStatus::ok;
    const auto                 gradients = mean_gradients(motion);
    dealii::FullMatrix<double> K_cell(dim * n);
    std::vector<bool>          is_done(points.n_kinds());
    StepStatus                 status = StepStatus::ok;
    points.dt                         = stage.dt;
    for (const auto &active : cells)
      if (const unsigned int kind = kinds()[active.number];
          kind != TwoMomentPoints<dim>::no_kind && !is_done[kind] && status == StepStatus::ok)
        {
          is_done[kind] = true;
          status        = points.gather(active, Gathered::for_solve, uniform(gradients[points.material_of_kind(kind)]));
          if (status == StepStatus::ok)
            status = find_stiffness(points, stage, K_cell);
          if (status == StepStatus::ok)
            visit(kind, K_cell);
        }
    return status;
  }

  template <int dim, unsigned int n>
  void
  StencilForces<dim, n>::commit(const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    if (points.n_history() == 0)
      return;
    for_cells(motion, stage, Gathered::all_points, [](const ActiveCell<dim> &, auto &p) {
      const StepStatus evaluated = p.evaluate(Materials::next_step);
      p.keep_history();
      return evaluated;
    });
  }

  template <int dim, unsigned int n>
  double
  StencilForces<dim, n>::round_off() const
  {
    return std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template <int dim, unsigned int n>
  double
  StencilForces<dim, n>::strain_energy() const
  {
    return dealii::Utilities::MPI::sum(energy, scene.comm);
  }

  template <int dim>
  std::unique_ptr<CellForces<dim>>
  CellForces<dim>::make(const Scene<dim> &scene, const Settings<dim> &settings, const BackgroundGrid<dim> &grid,
                        const Points<dim> &points, ActiveCells<dim> &cells)
  {
    if (grid.shape->n_nodes() == power(2, dim))
      return std::make_unique<StencilForces<dim, power(2, dim)>>(scene, settings, grid, points, cells);
    return std::make_unique<StencilForces<dim, power(3, dim)>>(scene, settings, grid, points, cells);
  }

  template class CellForces<2>;
  template class CellForces<3>;
} // namespace Stroma::Mpm
