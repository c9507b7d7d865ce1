// Fields and results of MpmMethod.

#include "point_state.h"

#include <stroma/base/text.h>
#include <stroma/mpm/method.h>
#include <stroma/output/grid_writer.h>
#include <stroma/output/statistics.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Mpm
{
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
    const auto                 chosen = Output::named(point_fields<dim>(), request.point_fields);
    std::vector<Output::Field> fields;
    for (const auto &field : chosen)
      fields.push_back({field.full_name(), field.components});
    Output::PointWriter<dim> writer(request.folder, "points", request.counter, fields, scene.comm, request.format);
    std::vector<double>      values(n_components(chosen));
    for_each_point(*system, *points, u,
                   [&](const PointState<dim> &state, const dealii::Point<dim> &x, const auto &) {
                     fill(chosen, state, values.data());
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
    for_each_point(*system, *points, u,
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
    system->set_committed(time, rebase_time, v);
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
    summary.laws            = scene.laws_in_words();
    for (const auto &[name, value] : committed_scalars)
      summary.results[name] = value;
    if (n_free_parts > 0)
      summary.results["free_parts"] = n_free_parts;
    if (below_round_off.count > 0)
      summary.results["solves_below_round_off"] = below_round_off.count;
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
    part(points->velocity_gradient.stored(), "point field: velocity gradient");
    part(points->history.stored(), "material history");
    part(!system->symmetric(), "GMRES instead of conjugate gradients");
    part(false, "ghost points");
  }

  template <int dim>
  void
  MpmMethod<dim>::stress_results(Output::Summary &summary)
  {
    Output::VolumeWeightedQuantiles quantiles;
    quantiles.reserve(points->handler.n_locally_owned_particles());
    for_each_point(*system, *points, u,
                   [&](const PointState<dim> &state, const dealii::Point<dim> &, const auto &) {
                     quantiles.add(Solid::von_mises(state.cauchy), state.V0);
                   });
    Output::von_mises_results(quantiles, scene.comm, summary.results);
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
    for_each_point(*system, *points, u,
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
