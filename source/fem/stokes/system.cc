#include <stroma/fem/stokes/system.h>

#include <deal.II/base/mpi.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <cmath>

using dealii::TrilinosWrappers::SparsityPattern;

namespace Stroma::Fem
{
  template <int dim>
  StokesSystem<dim>::StokesSystem(const StokesSpace<dim> &space, const Settings<dim> &settings)
    : space(space)
    , scene(space.scene)
    , settings(settings)
    , cell_quadrature(settings.n_quadrature_points())
    , thickness(dim == 2 ? scene.thickness : 1.)
    , external(space.new_velocity())
    , volumes(space.new_pressure())
  {
    for (const auto &medium : scene.media)
      {
        viscosities.emplace_back(medium);
        compressible |= std::isfinite(medium.bulk_modulus);
      }
    check_loads();
    // Those on rigid bodies are for FreeBodies.
    const std::vector<std::vector<SingleUnknown<dim>>> no_single_unknowns(scene.loads.size());
    if (!scene.loads.empty())
      loads = std::make_unique<Loads<dim>>(scene, settings, space.mesh,
                                           LoadedSpace<dim>{space.velocity_dofs, space.velocity_element,
                                                            space.tied_velocity, space.owned_velocity},
                                           no_single_unknowns);
    StokesCell<dim>        values(space, cell_quadrature);
    dealii::Vector<double> local(values.p_dofs.size());
    for (const auto &cell : space.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell, space);
          local = 0.;
          for (unsigned int q = 0; q < cell_quadrature.size(); ++q)
            for (unsigned int i = 0; i < local.size(); ++i)
              local[i] += values.pressure.shape_value(i, q) * thickness * values.velocity.JxW(q);
          space.tied_pressure.distribute_local_to_global(local, values.p_dofs, volumes);
        }
    volumes.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  void
  StokesSystem<dim>::make_patterns(StokesMatrices &m, const double rate) const
  {
    const auto square = [this](const dealii::DoFHandler<dim> &dofs, const dealii::IndexSet &relevant,
                               const dealii::AffineConstraints<double> &constraints, Matrix &matrix) {
      SparsityPattern pattern(dofs.locally_owned_dofs(), dofs.locally_owned_dofs(), relevant, scene.comm);
      dealii::DoFTools::make_sparsity_pattern(dofs, pattern, constraints, false,
                                              dealii::Utilities::MPI::this_mpi_process(scene.comm));
      pattern.compress();
      matrix.reinit(pattern);
    };
    square(space.velocity_dofs, space.relevant_velocity, space.fixed_velocity, m.A);
    square(space.pressure_dofs, space.relevant_pressure, space.tied_pressure, m.S);
    if (compressible && rate > 0.)
      square(space.pressure_dofs, space.relevant_pressure, space.tied_pressure, m.C);
    if (settings.inertia)
      square(space.pressure_dofs, space.relevant_pressure, space.tied_pressure, m.L);

    SparsityPattern pattern(space.owned_pressure, space.owned_velocity, space.relevant_pressure, scene.comm);
    StokesCell<dim> values(space, cell_quadrature);
    for (const auto &cell : space.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell, space);
          space.tied_pressure.add_entries_local_to_global(values.p_dofs, space.fixed_velocity, values.v_dofs, pattern,
                                                          false);
        }
    pattern.compress();
    m.B.reinit(pattern);
  }

  template <int dim>
  void
  StokesSystem<dim>::assemble(StokesMatrices &m, const double rate) const
  {
    make_patterns(m, rate);
    StokesCell<dim> values(space, cell_quadrature);
    for (const auto &cell : space.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell, space);
          add_velocity(values, cell, m, rate);
          add_pressure(values, cell, m, rate);
        }
    for (Matrix *matrix : {&m.A, &m.B, &m.S})
      matrix->compress(dealii::VectorOperation::add);
    if (compressible && rate > 0.)
      m.C.compress(dealii::VectorOperation::add);
    if (settings.inertia)
      m.L.compress(dealii::VectorOperation::add);
  }

  /// rho rate (v, w) + (viscous stress of v, grad w), symmetric.
  template <int dim>
  void
  StokesSystem<dim>::add_velocity(const StokesCell<dim> &values, const Iterator &cell, StokesMatrices &m,
                                  const double rate) const
  {
    const unsigned int         n = values.v_dofs.size();
    const auto                &c = values.component;
    dealii::FullMatrix<double> local(n, n);
    for (unsigned int q = 0; q < cell_quadrature.size(); ++q)
      {
        const unsigned int     k   = material(cell, values.velocity.quadrature_point(q));
        const StokesViscosity &mu  = viscosities[k];
        const double           JxW = thickness * values.velocity.JxW(q);
        const double           rho = settings.inertia ? rate * scene.media[k].density : 0.;
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j <= i; ++j)
            {
              const auto &g_i   = values.velocity.shape_grad(i, q);
              const auto &g_j   = values.velocity.shape_grad(j, q);
              double      entry = mu.transpose * g_i[c[j]] * g_j[c[i]] + mu.divergence * g_i[c[i]] * g_j[c[j]];
              if (c[i] == c[j])
                entry += mu.gradient * (g_i * g_j) +
                         rho * values.velocity.shape_value(i, q) * values.velocity.shape_value(j, q);
              local(i, j) += entry * JxW;
            }
      }
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int j = i + 1; j < n; ++j)
        local(i, j) = local(j, i);
    space.fixed_velocity.distribute_local_to_global(local, values.v_dofs, m.A);
  }

  template <int dim>
  void
  StokesSystem<dim>::add_pressure(const StokesCell<dim> &values, const Iterator &cell, StokesMatrices &m,
                                  const double rate) const
  {
    const unsigned int         n = values.p_dofs.size(), n_v = values.v_dofs.size();
    dealii::FullMatrix<double> B(n, n_v), C(n, n), S(n, n), L(n, n);
    for (unsigned int q = 0; q < cell_quadrature.size(); ++q)
      {
        const unsigned int k               = material(cell, values.velocity.quadrature_point(q));
        const double       JxW             = thickness * values.velocity.JxW(q);
        const double       compressibility = rate / scene.media[k].bulk_modulus;
        for (unsigned int i = 0; i < n; ++i)
          {
            const double q_i = values.pressure.shape_value(i, q);
            for (unsigned int j = 0; j < n_v; ++j)
              B(i, j) -= q_i * values.velocity.shape_grad(j, q)[values.component[j]] * JxW;
            for (unsigned int j = 0; j < n; ++j)
              {
                const double mass = q_i * values.pressure.shape_value(j, q) * JxW;
                C(i, j) += compressibility * mass;
                S(i, j) += (1. / viscosities[k].p_wave() + compressibility) * mass;
                if (settings.inertia)
                  L(i, j) += values.pressure.shape_grad(i, q) * values.pressure.shape_grad(j, q) * JxW /
                               (rate * scene.media[k].density) +
                             compressibility * mass;
              }
          }
      }
    space.tied_pressure.distribute_local_to_global(B, values.p_dofs, space.fixed_velocity, values.v_dofs, m.B);
    space.tied_pressure.distribute_local_to_global(S, values.p_dofs, m.S);
    if (compressible && rate > 0.)
      space.tied_pressure.distribute_local_to_global(C, values.p_dofs, m.C);
    if (settings.inertia)
      space.tied_pressure.distribute_local_to_global(L, values.p_dofs, m.L);
  }

  template <int dim>
  void
  StokesSystem<dim>::residual(StokesFlow &r, const StokesFlow &flow, const StokesRates &rates) const
  {
    r = {external, space.new_pressure()};
    subtract_left_hand_sides(r, flow, rates);
  }

  template <int dim>
  void
  StokesSystem<dim>::homogeneous_residual(StokesFlow &r, const StokesFlow &flow, const double rate) const
  {
    r = {space.new_velocity(), space.new_pressure()};
    subtract_left_hand_sides(r, flow, {rate, {}, {}});
  }

  template <int dim>
  void
  StokesSystem<dim>::subtract_left_hand_sides(StokesFlow &r, const StokesFlow &flow, const StokesRates &rates) const
  {
    const auto [v, p]             = with_ghosts(flow);
    const auto [v_known, p_known] = with_ghosts({rates.velocity_known, rates.pressure_known});

    StokesCell<dim>        values(space, cell_quadrature);
    const unsigned int     n_q = cell_quadrature.size(), n_v = values.v_dofs.size(), n_p = values.p_dofs.size();
    dealii::Vector<double> local_v(n_v), local_p(n_p);
    std::vector<dealii::Tensor<1, dim>>      v_q(n_q), v_known_q(n_q);
    std::vector<dealii::Tensor<2, dim>>      G(n_q);
    std::vector<double>                      p_q(n_q), p_known_q(n_q);
    const dealii::FEValuesExtractors::Vector vector(0);
    for (const auto &cell : space.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell, space);
          values.velocity[vector].get_function_values(v, v_q);
          values.velocity[vector].get_function_values(v_known, v_known_q);
          values.velocity[vector].get_function_gradients(v, G);
          values.pressure.get_function_values(p, p_q);
          values.pressure.get_function_values(p_known, p_known_q);
          local_v = 0.;
          local_p = 0.;
          for (unsigned int q = 0; q < n_q; ++q)
            {
              const unsigned int k      = material(cell, values.velocity.quadrature_point(q));
              const double       JxW    = thickness * values.velocity.JxW(q);
              auto               stress = viscosities[k].stress(G[q]);
              for (unsigned int d = 0; d < dim; ++d)
                stress[d][d] -= p_q[q];
              dealii::Tensor<1, dim> inertia;
              if (settings.inertia)
                inertia = scene.media[k].density * (rates.rate * v_q[q] + v_known_q[q]);
              for (unsigned int i = 0; i < n_v; ++i)
                local_v[i] -= (stress[values.component[i]] * values.velocity.shape_grad(i, q) +
                               inertia[values.component[i]] * values.velocity.shape_value(i, q)) *
                              JxW;
              const double dilation = trace(G[q]) + (rates.rate * p_q[q] + p_known_q[q]) / scene.media[k].bulk_modulus;
              for (unsigned int i = 0; i < n_p; ++i)
                local_p[i] += values.pressure.shape_value(i, q) * dilation * JxW;
            }
          space.tied_velocity.distribute_local_to_global(local_v, values.v_dofs, r.v);
          space.tied_pressure.distribute_local_to_global(local_p, values.p_dofs, r.p);
        }
    r.v.compress(dealii::VectorOperation::add);
    r.p.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  bool
  StokesSystem<dim>::level_is_free(const StokesMatrices &m) const
  {
    if (m.C.m() > 0)
      return false;
    // A constant pressure does no work on any velocity that is not held.
    Vector one = space.new_pressure(), work = space.new_velocity();
    one = 1.;
    space.tied_pressure.set_zero(one);
    m.B.Tvmult(work, one);
    return work.linfty_norm() < 1e-8 * m.B.linfty_norm();
  }

  template <int dim>
  void
  StokesSystem<dim>::make_compatible(Vector &r) const
  {
    const double volume = volumes.mean_value() * volumes.size();
    r.add(-r.mean_value() * r.size() / volume, volumes);
  }

  template <int dim>
  void
  StokesSystem<dim>::remove_mean(Vector &p) const
  {
    const double volume = volumes.mean_value() * volumes.size();
    p.add(-(p * volumes) / volume);
  }

  template <int dim>
  StokesFlow
  StokesSystem<dim>::with_ghosts(const StokesFlow &flow) const
  {
    StokesFlow ghosted{Vector(space.owned_velocity, space.relevant_velocity, scene.comm),
                       Vector(space.owned_pressure, space.relevant_pressure, scene.comm)};
    if (flow.v.size() > 0)
      ghosted.v = flow.v;
    if (flow.p.size() > 0)
      ghosted.p = flow.p;
    return ghosted;
  }

  template <int dim>
  void
  StokesSystem<dim>::evaluate(std::vector<Point> &points, const StokesFlow &flow, StokesCell<dim> &values,
                              const Iterator &cell) const
  {
    values.reinit(cell, space);
    const unsigned int                       n = values.velocity.n_quadrature_points;
    std::vector<dealii::Tensor<1, dim>>      v(n);
    std::vector<dealii::Tensor<2, dim>>      G(n);
    std::vector<double>                      p(n);
    const dealii::FEValuesExtractors::Vector vector(0);
    values.velocity[vector].get_function_values(flow.v, v);
    values.velocity[vector].get_function_gradients(flow.v, G);
    values.pressure.get_function_values(flow.p, p);
    points.resize(n);
    for (unsigned int q = 0; q < n; ++q)
      {
        const auto &X = values.velocity.quadrature_point(q);
        points[q]     = {X, v[q], G[q], p[q], thickness * values.velocity.JxW(q), material(cell, X)};
      }
  }

  template <int dim>
  void
  StokesSystem<dim>::for_each_point(const StokesFlow &flow, const dealii::Quadrature<dim> &quadrature,
                                    const Visit &visit) const
  {
    const StokesFlow   ghosted = with_ghosts(flow);
    StokesCell<dim>    values(space, quadrature);
    std::vector<Point> points;
    for (const auto &cell : space.mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          evaluate(points, ghosted, values, cell);
          for (const Point &point : points)
            visit(cell, point);
        }
  }

  template class StokesSystem<2>;
  template class StokesSystem<3>;
} // namespace Stroma::Fem
