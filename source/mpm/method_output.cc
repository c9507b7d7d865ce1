// Grid fields and results of MpmMethod.

#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/grid/vertex_fields.h>
#include <stroma/mpm/method.h>
#include <stroma/output/grid_writer.h>

namespace Stroma::Mpm
{
  /// Said once: what was computed is worth more than these fields.
  template <int dim>
  bool
  MpmMethod<dim>::has_room_for_grid()
  {
    const double n_cells = grid->n_active_cells();
    if (!grid_is_left_out && !Memory::has_room_now(scene.comm, n_cells * Output::memory_of_written_cell))
      {
        grid_is_left_out = true;
        Log::warning(
          "there is not the memory to write fields on a grid of " + grouped(grid->n_active_cells()) +
          " cells: from here on they are left out; set 'Output/Grid fields = false', or 'Output/Image fields' where "
          "the body is an image");
      }
    return !grid_is_left_out;
  }

  template <int dim>
  std::string
  MpmMethod<dim>::write_grid(const Output::FieldRequest &request)
  {
    if (!request.grid_fields || !has_room_for_grid())
      return "";
    const auto means = Output::cell_means(*state(false), {dim, {"von_mises", "pressure"}},
                                          grid->triangulation.n_active_cells());
    // Evaluated anew: of the state that is written, and not stored for scenes that write no grid.
    Vector unbalanced = system->new_vector();
    system->set_committed(time, rebase_time, v);
    system->residual(unbalanced, u);
    const VertexFields<dim>         vertices(*grid);
    const Vector                    displacement = vertices.values(system->on_grid(u));
    Vector                          force;
    std::vector<Output::NodalField> nodal = {{"displacement_since_reset", "m", &displacement}};
    if (grid->shape->interpolates()) // else forces act on nodes elsewhere
      {
        force = vertices.values(system->on_grid(system->unbalanced_forces()));
        nodal.push_back({"unbalanced_force", "N", &force});
      }
    auto cells = means.fields();
    cells.push_back({"material_volume", "m3", &means.volume});
    const auto positions = settings.may_reset() ? "as of the last reset of the grid" : "undeformed";
    return Output::write_grid<dim>(request.grid_file(positions), vertices.dofs, nodal, cells);
  }

  template <int dim>
  void
  MpmMethod<dim>::describe(Output::Summary &summary)
  {
    summary.method          = "mpm";
    summary.dimension       = dim;
    summary.n_points        = points->n_global();
    summary.n_cells         = grid->n_active_cells();
    summary.n_dofs          = system->n_unknowns();
    summary.bytes_per_point = points->bytes_per_point();
    summary.laws            = scene.laws_in_words();
    if (n_free_parts > 0)
      summary.results["free_parts"] = n_free_parts;
    if (below_round_off.count > 0)
      summary.results["solves_below_round_off"] = below_round_off.count;
    describe_parts(summary);
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
    part(points->sides.stored(), "point field: sides");
    part(points->weight.stored(), "point field: weight");
    part(points->load.stored(), "point field: load");
    part(points->are_found_in_images(), "voxels instead of points");
    part(K.m() > 0 || n_resets > 0, "matrix: stiffness"); // a reset leaves it empty
    part(u.size() > 0, "vector: displacement");
    part(last_increment.size() > 0, "vector: last increment");
    for (const auto &[name, is_there] : system->vectors())
      part(is_there, "vector: " + name);
    part(grid->n_active_cells() < grid->triangulation.n_global_active_cells(), "cells without unknowns");
    part(settings.may_reset(), "grid reset");
    part(!system->touching.empty(), "contact");
    const bool is_kept = system->kept_tangent() != nullptr;
    part(is_kept, "matrices of cells with geometric multigrid");
    part(!is_kept && linear_settings.preconditioner != Solvers::Preconditioner::jacobi, "algebraic multigrid");
    part(points->velocity_gradient.stored(), "point field: velocity gradient");
    part(points->history.stored(), "material history");
    part(!system->symmetric(), "GMRES instead of conjugate gradients");
    part(false, "ghost points");
    part(false, "inertia"); // densities say nothing
  }

  template class MpmMethod<2>;
  template class MpmMethod<3>;
} // namespace Stroma::Mpm
