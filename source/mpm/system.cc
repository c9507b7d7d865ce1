#include <stroma/mpm/contact_points.h>
#include <stroma/mpm/system.h>
#include <stroma/scene/rheology.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <optional>

namespace Stroma::Mpm
{
  template <int dim>
  System<dim>::System(const Scene<dim> &scene, const Settings<dim> &settings, BackgroundGrid<dim> &grid,
                      Points<dim> &points, PrescribedMotion<dim> &prescribed, Timers &timers)
    : SumOfTerms(timers, scene.comm)
    , bodies(scene)
    , touching(scene, bodies)
    , scene(scene)
    , settings(settings)
    , grid(grid)
    , points(points)
    , prescribed(prescribed)
    , cells(grid)
    , loads(scene, points, cells)
    , cell_forces(CellForces<dim>::make(scene, settings, grid, points, cells))
    , driven(scene, settings, grid, points, cells)
    , surfaces(scene, grid, cells, bodies)
    , turning(scene, bodies)
  {
    terms = {cell_forces.get(), &driven};
    if (!scene.rigid_bodies.empty())
      terms.insert(terms.end(), {&surfaces, &touching, &turning});
  }

  template <int dim>
  void
  System<dim>::rebuild()
  {
    const auto scope = timers.scope("unknowns");
    grid.distribute_unknowns(points.occupied_cells());
    auto all_owned = grid.nodes.owned, all_relevant = grid.nodes.relevant;
    if (!scene.rigid_bodies.empty())
      bodies.number(all_owned, all_relevant);
    prescribed.find_nodes(grid, bodies, all_relevant);
    cells.rebuild(prescribed.constraints());
    cell_forces->rebuild();
    driven.rebuild();
    surfaces.rebuild();
    reinit(all_owned, all_relevant, {is_viscous(scene), false}, !scene.loads.empty());
    cell_tangent.reset();
    held.clear();
    for (const auto &unknown : prescribed.held())
      held.push_back({unknown.dof, 0.});
    for (const auto &[r, c] : bodies.all_prescribed())
      held.push_back({bodies.unknown(r, c), 0.});
    const auto h = grid.box().cell_size;
    touching.rebuild(settings.contact, false, *std::min_element(h.begin_raw(), h.end_raw()),
                     [&](const Contact &) { return contact_points(scene, grid, cells, prescribed.constraints()); });
  }

  template <int dim>
  bool
  System<dim>::acts_in_cells_only() const
  {
    return std::all_of(terms.begin(), terms.end(),
                       [](const Solvers::Term *term) { return term->acts_in_cells_only(); });
  }

  template <int dim>
  void
  System<dim>::keep_tangent()
  {
    std::vector<dealii::types::global_dof_index> dofs;
    std::vector<bool>                            is_single;
    for (const auto &unknown : prescribed.held())
      {
        dofs.push_back(unknown.dof);
        is_single.push_back(scene.supports[unknown.support].region.kind == Region<dim>::Kind::nearest);
      }
    cell_tangent = std::make_unique<CellTangent<dim>>(grid, dofs, is_single, cell_forces->kinds());
  }

  template <int dim>
  StepStatus
  System<dim>::tangent(Matrix &K, Vector &r, const Vector &u)
  {
    if (!cell_tangent)
      return SumOfTerms::tangent(K, r, u);
    const auto scope = timers.scope("stiffness");
    find_motion(u);
    cell_tangent->begin();
    StepStatus status = cell_forces->for_each_kind(motion, stage,
                                                   [&](const unsigned int                kind,
                                                       const dealii::FullMatrix<double> &K_cell) {
                                                     cell_tangent->set_kind(kind, K_cell);
                                                   });
    status            = worse(status, cell_forces->for_each_stiffness(motion, stage,
                                                                      [&](const ActiveCell<dim>            &active,
                                                               const dealii::FullMatrix<double> &K_cell) {
                                                             cell_tangent->set(active.number, K_cell);
                                                           }));
    status            = reduce(status, comm);
    std::vector<double> jump;
    for (const auto &unknown : held)
      jump.push_back(unknown.target - motion.u(unknown.dof));
    cell_tangent->finish();
    cell_tangent->lift(jump, r);
    return status;
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
    stage = next;
    touching.set_stage(stage.v_factor);
    const auto &unknown = prescribed.held();
    if (!stage.is_last)
      motion.v = stage.v_known;
    for (std::size_t i = 0; i < unknown.size(); ++i)
      held[i].target = stage.is_last ? prescribed.motion_of(unknown[i], stage.t, t_rebase) :
                                       (prescribed.rate_of(unknown[i], stage.t, t_rebase, stage.dt / 1024.) -
                                        motion.v(unknown[i].dof)) /
                                         stage.v_factor;
    const auto of_bodies = bodies.all_prescribed();
    for (std::size_t i = 0; i < of_bodies.size(); ++i)
      {
        const auto [r, c]   = of_bodies[i];
        auto &[dof, target] = held[unknown.size() + i];
        target              = stage.is_last ?
                                bodies.prescribed(r, c, stage.t) :
                                (bodies.prescribed_rate(r, c, stage.t, stage.dt / 1024.) - motion.v(dof)) / stage.v_factor;
      }
    if (!scene.loads.empty())
      {
        loads.assemble(stage.t, external);
        bodies.add_forces(stage.t, external);
        external.compress(dealii::VectorOperation::add);
      }
  }

  template <int dim>
  void
  System<dim>::end_step(const Vector &v)
  {
    stage.dt = stage.v_factor = 0.;
    stage.is_last             = true;
    stage.v_known             = v;
    if (cell_tangent) // nothing of it goes to the next step
      cell_tangent->release();
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
    for (const auto &[r, c] : bodies.all_prescribed())
      if (const int support = scene.rigid_bodies[r].drive.support; support >= 0 && c < dim)
        total[support][c] -= owned.is_element(bodies.unknown(r, c)) ? unbalanced(bodies.unknown(r, c)) : 0.;
    for (auto &force : total)
      force = dealii::Utilities::MPI::sum(force, comm);
    return total;
  }

  template <int dim>
  FreeParts<dim>
  System<dim>::free_parts(const ConnectedParts<dim> &parts, const double end_time) const
  {
    FreeParts<dim> free(scene, parts, scene.rigid_bodies.size());
    for (const auto &active : cells)
      {
        std::optional<unsigned int> of_first; // which stands for the cell
        points.for_points_of(active, [&](const auto &, const auto &, const unsigned int m, const double) {
          of_first = of_first.value_or(m);
        });
        free.add_cell(active.cell, *of_first);
      }
    prescribed.hold(free.motions, parts, grid, points);
    surfaces.join(free.motions, parts);
    bodies.hold(free.motions, parts.size(), [this](const dealii::types::global_dof_index dof) {
      return prescribed.constraints().is_constrained(dof);
    });
    free.find();
    check_loads(free, parts, end_time);
    return free;
  }

  template <int dim>
  void
  System<dim>::check_loads(FreeParts<dim> &free, const ConnectedParts<dim> &parts, const double end_time) const
  {
    free.check_loads(end_time, [&](const double t, const auto &add_force) {
      loads.for_each(t, [&](const ActiveCell<dim> &active, const auto &point, const dealii::Tensor<1, dim> &force) {
        add_force(parts.piece_of(active.cell), point.get_location(), force);
      });
      bodies.visit_loads(t, parts.size(), add_force);
    });
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  System<dim>::rigid_results(const Vector &u)
  {
    if (scene.rigid_bodies.empty())
      return {};
    auto all = bodies.results(u, [&](const dealii::types::global_dof_index dof) {
      return unbalanced(dof) - (external.size() > 0 ? external(dof) : 0.) - turning.force(dof);
    });
    motion.u = u;
    for (const auto &scalar : touching.scalars(motion.u, motion.u))
      all.push_back(scalar);
    return all;
  }

  template <int dim>
  void
  System<dim>::fill_empty_rows(Matrix &K, Vector &r, const Solvers::Constraints &constraints) const
  {
    if (!scene.rigid_bodies.empty())
      bodies.fill_empty_rows(K, r, constraints);
  }

  template <int dim>
  Vector
  System<dim>::on_grid(const Vector &u) const
  {
    Vector part(grid.nodes.owned, comm);
    std::copy_n(u.begin(), part.locally_owned_size(), part.begin()); // the grid's unknowns come first
    return part;
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
    bodies.set_motions(motions, centre, length, [this](const dealii::types::global_dof_index dof) {
      return prescribed.constraints().is_constrained(dof);
    });
    for (auto &m : motions)
      m.compress(dealii::VectorOperation::insert);
    return motions;
  }

  template class System<2>;
  template class System<3>;
} // namespace Stroma::Mpm
