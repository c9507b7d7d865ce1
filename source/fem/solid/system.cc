#include <stroma/fem/solid/contact_points.h>
#include <stroma/fem/solid/system.h>
#include <stroma/scene/rheology.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace Stroma::Fem
{
  template <int dim>
  SolidSystem<dim>::SolidSystem(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
                                Unknowns<dim> &unknowns, Timers &timers)
    : SumOfTerms(timers, scene.comm)
    , cells(scene, settings, mesh, unknowns)
    , touching(scene, unknowns.inclusions)
    , scene(scene)
    , settings(settings)
    , mesh(mesh)
    , unknowns(unknowns)
    , loads(scene, settings, mesh, {unknowns.dofs, unknowns.fe, unknowns.mesh_ties, unknowns.owned},
            unknowns.loaded_singly())
    , turning(scene, unknowns.inclusions)
    , inertia(scene, unknowns.inclusions)
    , assembled_factors{{std::nan(""), 0., 0.}}
  {
    reinit(unknowns.owned, unknowns.relevant, {is_viscous(scene) || settings.inertia, settings.inertia},
           !scene.loads.empty());
    for (const auto &unknown : unknowns.held)
      held.push_back({unknown.dof, 0.});
    touching.rebuild(settings.contact, settings.inertia, mesh.smallest_cell(),
                     [&](const Contact &) { return contact_points(scene, settings, mesh, unknowns); });
    terms = {&cells, &touching, &turning};
    if (settings.inertia)
      terms.push_back(&inertia);
  }

  template <int dim>
  void
  SolidSystem<dim>::set_stage(const Solvers::Stage &next, const double t_next, const Vector &start)
  {
    stage = next;
    touching.set_stage(stage.v_factor);
    find_targets(t_next, start);
    if (!scene.loads.empty())
      {
        const auto scope = timers.scope("targets and loads");
        loads.assemble(stage.t, external);
      }
  }

  /// Displacements of held unknowns in this stage, see Solvers::Stage.
  template <int dim>
  void
  SolidSystem<dim>::find_targets(const double t_next, const Vector &start)
  {
    if (stage.start_weight > 0.)
      motion.u = start;
    else if (!stage.is_last)
      motion.v = stage.v_known;
    for (std::size_t i = 0; i < held.size(); ++i)
      {
        const auto &unknown = unknowns.held[i];
        double     &target  = held[i].target;
        if (stage.is_last)
          target = unknowns.prescribed(unknown, t_next);
        else
          target = (unknowns.prescribed_rate(unknown, stage.t, stage.dt / 1024.) - motion.v(unknown.dof)) /
                   stage.v_factor;
        if (stage.start_weight > 0.)
          target += stage.start_weight * (motion.u(unknown.dof) - target);
      }
  }

  /// Forces on the surfaces of rigid bodies act on these.
  template <int dim>
  void
  SolidSystem<dim>::condense(Vector &force)
  {
    if (!scene.rigid_bodies.empty())
      turning.virials = unknowns.inclusions.condense(force, unknowns.inclusions.poses(motion.u));
  }

  /// Whether the tangent is the one assembled last: a linear system, the same stage factors, nothing to lift.
  template <int dim>
  bool
  SolidSystem<dim>::is_assembled(const std::vector<double> &jump)
  {
    const std::array<double, 3> factors{{stage.v_factor, stage.a_factor, stage.dt}};
    if (settings.kinematics == Kinematics::small && touching.empty() && !unknowns.inclusions.turn() &&
        assembled_factors == factors)
      {
        const int jumps = std::any_of(jump.begin(), jump.end(), [](const double j) { return j != 0.; });
        if (dealii::Utilities::MPI::max(jumps, comm) == 0)
          return true;
      }
    assembled_factors = factors;
    return false;
  }

  template <int dim>
  FreeParts<dim>
  SolidSystem<dim>::free_parts(const ConnectedParts<dim> &parts, const double end_time)
  {
    FreeParts<dim> free(scene, parts, scene.rigid_bodies.size());
    for (const auto &cell : mesh.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        free.add_cell(cell, cell->material_id());
    unknowns.hold(free.motions, parts);
    free.find();
    free.check_loads(end_time, [&](const double t, const auto &add_force) {
      if (scene.loads.empty())
        return;
      loads.assemble(t, external);
      unknowns.visit_forces(external, parts, add_force);
      unknowns.inclusions.visit_torques(t, parts.size(), add_force);
    });
    return free;
  }

  template <int dim>
  StepStatus
  SolidSystem<dim>::evaluate_end(const Solvers::Motion &end, const double t)
  {
    stage         = Solvers::Stage();
    stage.v_known = end.v;
    stage.a_known = end.a;
    find_motion(end.u);
    unbalanced              = 0.;
    const StepStatus status = cells.add_force(unbalanced, motion, stage);
    inertia.add_force(unbalanced, motion, stage);
    unbalanced.compress(dealii::VectorOperation::add);
    if (touching.force().size() > 0)
      unbalanced += touching.force();
    if (!scene.loads.empty())
      {
        loads.assemble(t, external);
        unbalanced += external;
      }
    condense(unbalanced);
    return reduce(status, comm);
  }

  template <int dim>
  void
  SolidSystem<dim>::start_held(Vector &v, const double h) const
  {
    for (const auto &unknown : unknowns.held)
      if (unknowns.owned.is_element(unknown.dof))
        v(unknown.dof) = unknowns.prescribed_rate(unknown, 0., -h);
    v.compress(dealii::VectorOperation::insert);
  }

  template <int dim>
  StepStatus
  SolidSystem<dim>::initial_acceleration(Solvers::LinearSolver &solver, Matrix &K, Vector &a, const Vector &u,
                                         const Vector &v, const double h)
  {
    Vector r(a);
    stage.v_factor = stage.a_factor = 0.;
    stage.v_known                   = v;
    stage.a_known                   = new_vector();
    const StepStatus status         = residual(r, u);
    if (status != StepStatus::ok)
      return status;
    shape(K);
    K                    = 0.;
    assembled_factors[0] = std::nan("");
    const auto M_rows    = constraints(prescribed_accelerations(h));
    cells.add_mass(K, r, M_rows);
    inertia.add_mass(K);
    K.compress(dealii::VectorOperation::add);
    r.compress(dealii::VectorOperation::add);
    for (dealii::types::global_dof_index i = unknowns.dofs.n_dofs(); i < unknowns.size(); ++i)
      if (owned.is_element(i) && K.diag_element(i) == 0.)
        K.set(i, i, 1.);
    K.compress(dealii::VectorOperation::insert);
    const bool solved = solver.solve(K, a, r, 1e-12).converged;
    solver.forget();
    unknowns.distribute_rate(a);
    return solved ? StepStatus::ok : StepStatus::linear_failed;
  }

  /// Accelerations of held unknowns at the start, of second order in the short time @p h.
  template <int dim>
  std::vector<double>
  SolidSystem<dim>::prescribed_accelerations(const double h) const
  {
    std::vector<double> accelerations(held.size(), 0.);
    for (std::size_t i = 0; i < accelerations.size(); ++i)
      {
        const auto g     = [&](const double t) { return unknowns.prescribed(unknowns.held[i], t); };
        accelerations[i] = (2. * g(0.) - 5. * g(h) + 4. * g(2. * h) - g(3. * h)) / (h * h);
      }
    return accelerations;
  }

  template <int dim>
  std::vector<dealii::Tensor<1, dim>>
  SolidSystem<dim>::reactions() const
  {
    std::vector<dealii::Tensor<1, dim>> total(scene.supports.size());
    for (const auto &unknown : unknowns.held)
      if (unknowns.owned.is_element(unknown.dof) && unknown.support < total.size() && unknown.component < dim)
        total[unknown.support][unknown.component] -= unbalanced(unknown.dof);
    for (auto &force : total)
      force = dealii::Utilities::MPI::sum(force, comm);
    return total;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  SolidSystem<dim>::reactions_at_rest() const
  {
    std::vector<std::pair<std::string, double>> scalars;
    for (const auto &unknown : unknowns.held)
      if (unknown.rigid >= 0 && unknown.component < dim && unknown.support == scene.supports.size())
        scalars.emplace_back(
          "reaction_" + scene.rigid_bodies[unknown.rigid].name + "_" + "xyz"[unknown.component] + "_N",
          dealii::Utilities::MPI::sum(unknowns.owned.is_element(unknown.dof) ? -unbalanced(unknown.dof) : 0., comm));
    return scalars;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  SolidSystem<dim>::rigid_scalars(const Vector &u)
  {
    return unknowns.inclusions.results(u, [&](const dealii::types::global_dof_index dof) {
      return unbalanced(dof) - (external.size() > 0 ? external(dof) : 0.) - turning.force(dof) - inertia.force(dof);
    });
  }

  template <int dim>
  double
  SolidSystem<dim>::kinetic_energy(const Vector &v)
  {
    Vector tied(v);
    tie_rate(tied);
    motion.a = tied;
    return cells.kinetic_energy(motion.a) + inertia.kinetic_energy(v);
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  SolidSystem<dim>::contact_scalars(const Vector &u, const Vector &balanced)
  {
    motion.u = balanced;
    Vector relevant_end(motion.u);
    relevant_end = u;
    return touching.scalars(relevant_end, motion.u);
  }

  template class SolidSystem<2>;
  template class SolidSystem<3>;
} // namespace Stroma::Fem
