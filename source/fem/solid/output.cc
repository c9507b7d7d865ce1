// Grid fields and results of SolidMethod.

#include <stroma/fem/solid/method.h>
#include <stroma/output/grid_writer.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Fem
{
  template <int dim>
  std::string
  SolidMethod<dim>::write_grid(const Output::FieldRequest &request)
  {
    if (!request.grid_fields)
      return "";
    const auto means = Output::cell_means(*state(true), {dim, {"von_mises", "pressure", "material"}},
                                          mesh->triangulation.n_active_cells());
    auto       cells = means.fields();
    cells.push_back({"material_volume", "m3", &means.volume});
    const Vector                    displacement = unknowns->on_mesh(motion.u);
    const Vector                    velocity     = motion.v.size() > 0 ? unknowns->on_mesh(motion.v) : Vector();
    const Vector                    force        = unknowns->on_mesh(system->unbalanced_forces());
    std::vector<Output::NodalField> nodal        = {{"displacement", "m", &displacement}};
    if (velocity.size() > 0)
      nodal.push_back({"velocity", "m_per_s", &velocity});
    nodal.push_back({"unbalanced_force", "N", &force});
    return Output::write_grid<dim>(request.grid_file("undeformed"), unknowns->dofs, nodal, cells);
  }

  template <int dim>
  void
  SolidMethod<dim>::describe(Output::Summary &summary)
  {
    summary.method          = "fem";
    summary.dimension       = dim;
    summary.n_points        = 0;
    summary.n_cells         = mesh->triangulation.n_global_active_cells();
    summary.n_dofs          = unknowns->size();
    summary.bytes_per_point = std::nan("");
    summary.laws            = scene.laws_in_words(settings.kinematics == Kinematics::small);
    const auto part         = [&](const bool is_used, const std::string &name) {
      (is_used ? summary.used : summary.left_out).push_back(name);
    };
    part(K.m() > 0, "matrix: stiffness");
    part(motion.u.size() > 0, "vector: displacement");
    part(motion.v.size() > 0, "vector: velocity");
    part(motion.a.size() > 0, "vector: acceleration");
    part(last_increment.size() > 0, "vector: last increment");
    for (const auto &[name, is_there] : system->vectors())
      part(is_there, "vector: " + name);
    part(system->cells.history.size() > 0, "material history");
    part(!system->touching.empty(), "contact");
    part(unknowns->ties.n_constraints() > 0, "tied unknowns");
    part(settings.dilatation == Dilatation::projected, "projected dilatation");
    part(!system->symmetric(), "GMRES instead of conjugate gradients");
    part(linear_settings.preconditioner == Solvers::Preconditioner::amg, "algebraic multigrid");
    part(false, "points");
    part(settings.inertia, "inertia"); // without it densities say nothing
    if (n_free_parts > 0)
      summary.results["free_parts"] = n_free_parts;
    if (below_round_off.count > 0)
      summary.results["solves_below_round_off"] = below_round_off.count;
    summary.results["max_displacement_m"] = largest_displacement();
  }

  /// Of a node [m].
  template <int dim>
  double
  SolidMethod<dim>::largest_displacement() const
  {
    double                                       largest = 0;
    const Vector                                 u       = unknowns->on_mesh(motion.u);
    std::vector<dealii::types::global_dof_index> dofs(unknowns->fe.n_dofs_per_cell());
    for (const auto &cell : unknowns->dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          for (unsigned int i = 0; i < dofs.size() / dim; ++i)
            {
              double square = 0;
              for (unsigned int c = 0; c < dim; ++c)
                square += std::pow(u(dofs[unknowns->fe.component_to_system_index(c, i)]), 2);
              largest = std::max(largest, square);
            }
        }
    return std::sqrt(dealii::Utilities::MPI::max(largest, scene.comm));
  }

  template class SolidMethod<2>;
  template class SolidMethod<3>;
} // namespace Stroma::Fem
