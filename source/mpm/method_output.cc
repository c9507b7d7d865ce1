// Fields and results of MpmMethod.

#include <stroma/base/text.h>
#include <stroma/mpm/method.h>
#include <stroma/output/grid_writer.h>
#include <stroma/output/statistics.h>
#include <stroma/solid/stress_measures.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Mpm
{
  namespace
  {
    /// What is known of a point when it is written.
    template <int dim>
    struct PointState
    {
      dealii::Point<dim>            X; ///< undeformed place
      dealii::Tensor<1, dim>        u; ///< since the start
      dealii::SymmetricTensor<2, 3> cauchy;
      double                        V0, J;
      unsigned int                  material;
      dealii::Tensor<2, dim>        F;
    };

    template <int dim>
    struct PointField
    {
      std::string  name, unit;
      unsigned int components;
      void (*fill)(const PointState<dim> &, double *);
    };

    template <int dim>
    const std::vector<PointField<dim>> &
    point_fields()
    {
      using S = PointState<dim>;
      static const std::vector<PointField<dim>> table = {
        {"displacement", "m", dim, [](const S &s, double *v) { std::copy(s.u.begin_raw(), s.u.end_raw(), v); }},
        {"von_mises", "Pa", 1, [](const S &s, double *v) { *v = Solid::von_mises(s.cauchy); }},
        {"pressure", "Pa", 1, [](const S &s, double *v) { *v = Solid::pressure(s.cauchy); }},
        {"cauchy_stress", "Pa", 6,
         [](const S &s, double *v) {
           for (unsigned int i = 0; i < 6; ++i)
             v[i] = s.cauchy.access_raw_entry(i);
         }},
        {"J", "", 1, [](const S &s, double *v) { *v = s.J; }},
        {"material", "", 1, [](const S &s, double *v) { *v = s.material; }},
        {"volume", "m3", 1, [](const S &s, double *v) { *v = s.V0; }}};
      return table;
    }

    template <int dim>
    std::string
    full_name(const PointField<dim> &field)
    {
      return field.name + (field.unit.empty() ? "" : "_" + field.unit);
    }

    /// Calls @p visit(state, position) for every owned point of the state with grid displacement @p u.
    template <int dim, typename Visit>
    void
    for_each_point(System<dim> &system, const Scene<dim> &scene, const Points<dim> &points, const Vector &u,
                   const Visit &visit)
    {
      std::vector<dealii::SymmetricTensor<2, 3>> tau;
      std::vector<double>                        F33;
      system.for_each_cell(u, [&](const auto &active, const CellPoints<dim> &p, const auto &u_cell) {
        tau.resize(std::max<std::size_t>(tau.size(), p.size));
        F33.resize(std::max<std::size_t>(F33.size(), p.size));
        for (const auto &run : p.runs)
          {
            const unsigned int n = run.end - run.begin;
            scene.materials[run.material]->evaluate({{p.F.data() + run.begin, n}},
                                                    {{tau.data() + run.begin, n}, {}, {}, {F33.data() + run.begin, n}});
            for (unsigned int q = run.begin; q < run.end; ++q)
              {
                PointState<dim> state;
                state.u = p.grid_displacement(q, u_cell);
                const dealii::Point<dim> x = p.location[q] + state.u;
                if (points.displacement.stored())
                  for (unsigned int d = 0; d < dim; ++d)
                    state.u[d] += p.values[q][points.displacement.first + d];
                state.X = points.initial_place(p.location[q], p.values[q]);
                for (unsigned int i = 0; i < dim; ++i)
                  for (unsigned int k = 0; k < dim; ++k)
                    state.F[i][k] = p.F[q][i][k];
                state.J        = determinant(state.F) * (dim == 2 ? F33[q] : 1.);
                state.cauchy   = tau[q] / state.J;
                state.V0       = p.V[q];
                state.material = run.material;
                visit(state, x, active);
              }
          }
        return StepStatus::ok;
      });
    }
  } // namespace

  template <int dim>
  std::vector<std::string>
  MpmMethod<dim>::known_point_fields() const
  {
    std::vector<std::string> names;
    for (const auto &field : point_fields<dim>())
      names.push_back(field.name);
    return names;
  }

  template <int dim>
  std::vector<std::pair<std::string, std::string>>
  MpmMethod<dim>::write_fields(const FieldRequest &request)
  {
    const auto                                       scope = timers.scope("field files");
    std::vector<std::pair<std::string, std::string>> records;
    if (!request.point_fields.empty())
      records.emplace_back("points", write_points(request));
    if (request.grid_fields)
      records.emplace_back("grid", write_grid(request));
    return records;
  }

  template <int dim>
  std::string
  MpmMethod<dim>::write_points(const FieldRequest &request)
  {
    std::vector<const PointField<dim> *> chosen;
    std::vector<Output::Field>           fields;
    unsigned int                         n = 0;
    for (const auto &field : point_fields<dim>())
      if (std::find(request.point_fields.begin(), request.point_fields.end(), field.name) != request.point_fields.end())
        {
          chosen.push_back(&field);
          fields.push_back({full_name(field), field.components});
          n += field.components;
        }
    Output::PointWriter<dim> writer(request.folder, "points", request.counter, fields, scene.comm, request.format);
    std::vector<double>      values(n);
    for_each_point(*system, scene, *points, u,
                   [&](const PointState<dim> &state, const dealii::Point<dim> &x, const auto &) {
                     double *next = values.data();
                     for (const auto *field : chosen)
                       {
                         field->fill(state, next);
                         next += field->components;
                       }
                     writer.add(x, dealii::make_array_view(values));
                   });
    return writer.close();
  }

  template <int dim>
  std::string
  MpmMethod<dim>::write_grid(const FieldRequest &request)
  {
    const unsigned int     n_cells = grid->triangulation.n_active_cells();
    dealii::Vector<double> von_mises(n_cells), pressure(n_cells), volume(n_cells);
    for_each_point(*system, scene, *points, u,
                   [&](const PointState<dim> &state, const dealii::Point<dim> &, const auto &active) {
                     const unsigned int c = active.cell->active_cell_index();
                     volume[c] += state.V0;
                     von_mises[c] += state.V0 * Solid::von_mises(state.cauchy);
                     pressure[c] += state.V0 * Solid::pressure(state.cauchy);
                   });
    for (unsigned int c = 0; c < n_cells; ++c)
      if (volume[c] > 0)
        {
          von_mises[c] /= volume[c];
          pressure[c] /= volume[c];
        }
    // Evaluated anew: of the state that is written, and not stored for scenes that write no grid.
    Vector unbalanced = system->new_vector();
    system->set_time(time, rebase_time);
    system->residual(unbalanced, u);
    Vector displacement(grid->owned, grid->relevant, scene.comm), force(grid->owned, grid->relevant, scene.comm);
    displacement = u;
    force        = system->unbalanced_forces();
    return Output::write_grid<dim>(request.folder, "grid", request.counter, grid->dofs,
                                   {{"displacement_since_reset_m", &displacement}, {"unbalanced_force_N", &force}},
                                   {{"von_mises_Pa", &von_mises}, {"pressure_Pa", &pressure}, {"material_volume_m3", &volume}});
  }

  template <int dim>
  void
  MpmMethod<dim>::describe(Output::Summary &summary)
  {
    summary.method          = "mpm";
    summary.dimension       = dim;
    summary.n_points        = points->handler.n_global_particles();
    summary.n_cells         = grid->n_active_cells();
    summary.n_dofs          = system->n_unknowns();
    summary.bytes_per_point = points->bytes_per_point();
    for (const auto &[name, value] : committed_scalars)
      summary.results[name] = value;
    describe_parts(summary);
    const auto scope = timers.scope("results");
    stress_results(summary);
    error_results(summary);
  }

  template <int dim>
  void
  MpmMethod<dim>::describe_parts(Output::Summary &summary) const
  {
    const auto part = [&](const bool is_used, const std::string &name) {
      (is_used ? summary.used : summary.left_out).push_back(name);
    };
    // Read off what is there, not off the settings.
    part(points->volume.stored(), "point field: volume");
    part(points->material.stored(), "point field: material");
    part(points->deformation.stored(), "point field: deformation gradient");
    part(points->displacement.stored(), "point field: displacement");
    part(points->support.stored(), "point field: support");
    part(K.m() > 0, "matrix: stiffness");
    part(u.size() > 0, "vector: displacement");
    part(last_increment.size() > 0, "vector: last increment");
    for (const auto &[name, is_there] : system->vectors())
      part(is_there, "vector: " + name);
    part(grid->n_active_cells() < grid->triangulation.n_global_active_cells(), "cells without unknowns");
    part(settings.may_reset(), "grid reset");
    part(linear_settings.preconditioner == Solvers::Preconditioner::amg, "algebraic multigrid");
    part(false, "velocity and mass");
    part(false, "material history");
    part(false, "ghost points");
  }

  template <int dim>
  void
  MpmMethod<dim>::stress_results(Output::Summary &summary)
  {
    Output::VolumeWeightedQuantiles quantiles;
    quantiles.reserve(points->handler.n_locally_owned_particles());
    for_each_point(*system, scene, *points, u,
                   [&](const PointState<dim> &state, const dealii::Point<dim> &, const auto &) {
                     quantiles.add(Solid::von_mises(state.cauchy), state.V0);
                   });
    const auto found                      = quantiles.quantiles({.5, .99, .999}, scene.comm);
    summary.results["max_von_mises_Pa"]   = quantiles.max(scene.comm);
    summary.results["von_mises_p50_Pa"]   = found[0];
    summary.results["von_mises_p99_Pa"]   = found[1];
    summary.results["von_mises_p999_Pa"]  = found[2];
  }

  template <int dim>
  void
  MpmMethod<dim>::error_results(Output::Summary &summary)
  {
    if (!scene.exact_displacement.given())
      return;
    // Sums over the points: |u - u_exact|^2 V, |u_exact|^2 V, and the same for the gradients.
    std::array<double, 4> sums{{0, 0, 0, 0}};
    const double          step = 1e-5 * grid->box().cell_size.norm();
    for_each_point(*system, scene, *points, u,
                   [&](const PointState<dim> &s, const dealii::Point<dim> &, const auto &) {
                     const auto exact = scene.exact_displacement.value(s.X, time);
                     sums[0] += s.V0 * (s.u - exact).norm_square();
                     sums[1] += s.V0 * exact.norm_square();
                     for (unsigned int k = 0; k < dim; ++k)
                       {
                         const auto d     = dealii::Point<dim>::unit_vector(k) * step;
                         const auto slope = (scene.exact_displacement.value(s.X + d, time) -
                                             scene.exact_displacement.value(dealii::Point<dim>(s.X - d), time)) /
                                            (2 * step);
                         for (unsigned int i = 0; i < dim; ++i)
                           {
                             sums[2] += s.V0 * std::pow(s.F[i][k] - (i == k) - slope[i], 2);
                             sums[3] += s.V0 * std::pow(slope[i], 2);
                           }
                       }
                   });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 4, MPI_DOUBLE, MPI_SUM, scene.comm);
    summary.results["displacement_error_L2_relative"] = std::sqrt(sums[0] / sums[1]);
    summary.results["displacement_error_H1_relative"] = std::sqrt(sums[2] / sums[3]);
  }

  template class MpmMethod<2>;
  template class MpmMethod<3>;
} // namespace Stroma::Mpm
