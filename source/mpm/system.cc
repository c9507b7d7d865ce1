#include <stroma/mpm/system.h>
#include <stroma/scene/rheology.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Mpm
{
  template <int dim>
  System<dim>::System(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
                      Points<dim> &points, PrescribedMotion<dim> &prescribed, Timers &timers)
    : SumOfTerms(timers, scene.comm)
    , scene(scene)
    , grid(grid)
    , points(points)
    , prescribed(prescribed)
    , cells(grid)
    , loads(scene, points, cells)
    , cell_forces(CellForces<dim>::make(scene, settings, grid, points, cells))
    , driven(scene, settings, grid, points, cells)
    , surfaces(scene, grid, cells)
  {
    terms = {cell_forces.get(), &driven, &surfaces};
  }

  template <int dim>
  void
  System<dim>::rebuild()
  {
    const auto scope = timers.scope("unknowns");
    grid.distribute_unknowns(points.occupied_cells());
    prescribed.find_nodes(grid);
    cells.rebuild(prescribed.constraints());
    driven.rebuild();
    surfaces.rebuild();
    reinit(grid.nodes.owned, grid.nodes.relevant, {is_viscous(scene), false}, !scene.loads.empty());
    held.clear();
    for (const auto &unknown : prescribed.held())
      held.push_back({unknown.dof, 0.});
  }

  template <int dim>
  Solvers::Constraints
  System<dim>::constraints(const std::vector<double> &jump) const
  {
    Solvers::Constraints lifted(prescribed.constraints());
    for (std::size_t i = 0; i < held.size(); ++i)
      lifted.set_inhomogeneity(held[i].dof, jump[i]);
    return lifted;
  }

  template <int dim>
  void
  System<dim>::set_stage(const Solvers::Stage &next, const double t_rebase)
  {
    stage               = next;
    const auto &unknown = prescribed.held();
    if (!stage.is_last)
      motion.v = stage.v_known;
    for (std::size_t i = 0; i < held.size(); ++i)
      held[i].target = stage.is_last ? prescribed.motion_of(unknown[i], stage.t, t_rebase) :
                                       (prescribed.rate_of(unknown[i], stage.t, t_rebase, stage.dt / 1024.) -
                                        motion.v(unknown[i].dof)) /
                                         stage.v_factor;
    if (!scene.loads.empty())
      loads.assemble(stage.t, external);
  }

  template <int dim>
  void
  System<dim>::end_step(const Vector &v)
  {
    stage.dt = stage.v_factor = 0.;
    stage.is_last             = true;
    stage.v_known             = v;
  }

  template <int dim>
  void
  System<dim>::set_committed(const double t, const double t_rebase, const Vector &v)
  {
    Solvers::Stage committed;
    committed.t       = t;
    committed.v_known = v;
    set_stage(committed, t_rebase);
  }

  template <int dim>
  std::vector<dealii::Tensor<1, dim>>
  System<dim>::reactions() const
  {
    auto total = driven.reactions();
    for (const auto &unknown : prescribed.held())
      if (grid.nodes.owned.is_element(unknown.dof))
        total[unknown.support][unknown.component] -= unbalanced(unknown.dof);
    surfaces.add_reactions(total);
    for (auto &force : total)
      force = dealii::Utilities::MPI::sum(force, comm);
    return total;
  }

  template <int dim>
  FreeParts<dim>
  System<dim>::free_parts(const ConnectedParts<dim> &parts, const double end_time) const
  {
    FreeParts<dim> free(scene, parts);
    for (const auto &active : cells)
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        {
          free.add_cell(active.cell, points.material_of(point.get_properties().data()));
          break; // the cell's first stands for it
        }
    prescribed.hold(free.motions, parts, grid, points);
    surfaces.hold(free.motions, parts);
    free.find();
    free.check_loads(end_time, [&](const double t, const auto &add_force) {
      loads.for_each(t, [&](const ActiveCell<dim> &active, const auto &point, const dealii::Tensor<1, dim> &force) {
        add_force(parts.piece_of(active.cell), point.get_location(), force);
      });
    });
    return free;
  }

  template <int dim>
  std::vector<Vector>
  System<dim>::rigid_motions() const
  {
    constexpr unsigned int n_rotations = dim == 2 ? 1 : 3;
    std::vector<Vector>    motions(dim + n_rotations, new_vector());
    const auto             box    = grid.box();
    const auto             centre = box.lower + .5 * (box.upper() - box.lower);
    double                 length = 0;
    for (unsigned int d = 0; d < dim; ++d)
      length = std::max(length, box.upper()[d] - box.lower[d]);
    for (std::size_t node = 0; node < grid.nodes.n_nodes(); ++node)
      {
        const auto at = grid.nodes.node(node);
        if (!grid.nodes.owned.is_element(at.unknown))
          continue;
        const dealii::Tensor<1, dim> x   = (at.X - centre) / length;
        const auto                   set = [&](const unsigned int mode, const unsigned int c, const double value) {
          if (!prescribed.constraints().is_constrained(at.unknown + c))
            motions[mode](at.unknown + c) = value;
        };
        for (unsigned int c = 0; c < dim; ++c)
          set(c, c, 1.);
        for (unsigned int axis = 0; axis < n_rotations; ++axis)
          {
            const unsigned int i = dim == 2 ? 0 : (axis + 1) % 3, j = dim == 2 ? 1 : (axis + 2) % 3;
            set(dim + axis, i, -x[j]);
            set(dim + axis, j, x[i]);
          }
      }
    for (auto &m : motions)
      m.compress(dealii::VectorOperation::insert);
    return motions;
  }

  template class System<2>;
  template class System<3>;
} // namespace Stroma::Mpm
