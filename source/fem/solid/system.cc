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
    , scene(scene)
    , settings(settings)
    , mesh(mesh)
    , unknowns(unknowns)
    , loads(scene, settings, mesh, {unknowns.dofs, unknowns.fe, unknowns.ties, unknowns.owned},
            unknowns.loaded_singly())
    , touching(contacts)
    , assembled_factors{{std::nan(""), 0., 0.}}
  {
    reinit(unknowns.owned, unknowns.relevant, {is_viscous(scene) || settings.inertia, settings.inertia},
           !scene.loads.empty());
    for (const auto &unknown : unknowns.held)
      held.push_back({unknown.dof, 0.});
    for (const auto &contact : scene.contacts)
      contacts.emplace_back(scene, contact, settings, mesh, unknowns);
    terms = {&cells, &touching};
  }

  template <int dim>
  void
  SolidSystem<dim>::set_stage(const Solvers::Stage &next, const double t_next, const Vector &start)
  {
    stage = next;
    for (auto &contact : contacts)
      contact.set_stage(stage.v_factor);
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
        double     &target = held[i].target = 0.;
        if (unknown.support == scene.supports.size())
          continue;
        const auto &g = scene.supports[unknown.support].displacement;
        if (stage.is_last)
          target = g.value(unknown.X, t_next, unknown.component);
        else
          target = (g.rate(unknown.X, stage.t, unknown.component, stage.dt / 1024.) - motion.v(unknown.dof)) /
                   stage.v_factor;
        if (stage.start_weight > 0.)
          target += stage.start_weight * (motion.u(unknown.dof) - target);
      }
  }

  /// Rigid bodies have rows of their own.
  template <int dim>
  void
  SolidSystem<dim>::add_pattern(Solvers::Pattern &pattern) const
  {
    for (dealii::types::global_dof_index i = unknowns.dofs.n_dofs(); i < unknowns.size(); ++i)
      if (owned.is_element(i))
        pattern.add(i, i);
  }

  /// Those that are held, or touch nothing.
  template <int dim>
  void
  SolidSystem<dim>::fill_empty_rows(Matrix &K, Vector &r, const Solvers::Constraints &constraints) const
  {
    const double scale = scene.materials.front()->p_wave_modulus() * scene.thickness;
    for (dealii::types::global_dof_index i = unknowns.dofs.n_dofs(); i < unknowns.size(); ++i)
      if (owned.is_element(i) && K.diag_element(i) == 0.)
        {
          K.set(i, i, scale);
          r(i) = constraints.is_constrained(i) ? scale * constraints.get_inhomogeneity(i) : 0.;
        }
    K.compress(dealii::VectorOperation::insert);
    r.compress(dealii::VectorOperation::insert);
  }

  /// Whether the tangent is the one assembled last: a linear system, the same stage factors, nothing to lift.
  template <int dim>
  bool
  SolidSystem<dim>::is_assembled(const std::vector<double> &jump)
  {
    const std::array<double, 3> factors{{stage.v_factor, stage.a_factor, stage.dt}};
    if (settings.kinematics == Kinematics::small && contacts.empty() && assembled_factors == factors)
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
    FreeParts<dim> free(scene, parts, unknowns.n_rigid_bodies());
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
    unbalanced.compress(dealii::VectorOperation::add);
    if (touching.force().size() > 0)
      unbalanced += touching.force();
    if (!scene.loads.empty())
      {
        loads.assemble(t, external);
        unbalanced += external;
      }
    return reduce(status, comm);
  }

  template <int dim>
  void
  SolidSystem<dim>::start_step(const Vector &u)
  {
    Vector tied(u);
    tie(tied);
    motion.u = tied;
    for (auto &contact : contacts)
      contact.start_step(motion.u);
  }

  template <int dim>
  void
  SolidSystem<dim>::restore()
  {
    for (auto &contact : contacts)
      contact.restore();
  }

  template <int dim>
  bool
  SolidSystem<dim>::approach(Vector &u)
  {
    bool reaches = true;
    for (auto &contact : contacts)
      reaches &= scene.loads.empty() || contact.approach(u, external);
    return reaches;
  }

  template <int dim>
  bool
  SolidSystem<dim>::update_contact(const Vector &u)
  {
    if (contacts.empty())
      return false;
    motion.u   = u;
    bool again = false;
    for (auto &contact : contacts)
      again |= contact.update(motion.u);
    return again;
  }

  template <int dim>
  void
  SolidSystem<dim>::start_held(Vector &v, const double h) const
  {
    for (const auto &unknown : unknowns.held)
      if (unknowns.owned.is_element(unknown.dof))
        v(unknown.dof) = unknown.support < scene.supports.size() ?
                           scene.supports[unknown.support].displacement.rate(unknown.X, 0., unknown.component, -h) :
                           0.;
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
    K                    = 0.;
    assembled_factors[0] = std::nan("");
    const auto M_rows    = constraints(prescribed_accelerations(h));
    cells.add_mass(K, r, M_rows);
    K.compress(dealii::VectorOperation::add);
    r.compress(dealii::VectorOperation::add);
    for (dealii::types::global_dof_index i = unknowns.dofs.n_dofs(); i < unknowns.size(); ++i)
      if (owned.is_element(i) && K.diag_element(i) == 0.)
        K.set(i, i, 1.);
    K.compress(dealii::VectorOperation::insert);
    const bool solved = solver.solve(K, a, r, 1e-12).converged;
    solver.forget();
    unknowns.distribute(a);
    return solved ? StepStatus::ok : StepStatus::linear_failed;
  }

  /// Accelerations of held unknowns at the start, of second order in the short time @p h.
  template <int dim>
  std::vector<double>
  SolidSystem<dim>::prescribed_accelerations(const double h) const
  {
    std::vector<double> accelerations(held.size(), 0.);
    for (std::size_t i = 0; i < accelerations.size(); ++i)
      if (const auto &unknown = unknowns.held[i]; unknown.support < scene.supports.size())
        {
          const auto g = [&](const double t) {
            return scene.supports[unknown.support].displacement.value(unknown.X, t, unknown.component);
          };
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
      if (unknowns.owned.is_element(unknown.dof) && unknown.support < total.size())
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
    for (unsigned int b = 0; b < scene.bodies.size(); ++b)
      for (unsigned int c = 0; c < dim && scene.bodies[b].rigid; ++c)
        for (const auto &unknown : unknowns.held)
          if (unknown.dof == unknowns.of_body(b, c) && unknown.support == scene.supports.size())
            scalars.emplace_back("reaction_" + scene.bodies[b].name + "_" + "xyz"[c] + "_N",
                                 dealii::Utilities::MPI::sum(
                                   unknowns.owned.is_element(unknown.dof) ? -unbalanced(unknown.dof) : 0., comm));
    return scalars;
  }

  template <int dim>
  double
  SolidSystem<dim>::kinetic_energy(const Vector &v)
  {
    Vector tied(v);
    tie(tied);
    motion.a = tied;
    return cells.kinetic_energy(motion.a);
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  SolidSystem<dim>::contact_scalars(const Vector &u, const Vector &balanced)
  {
    std::vector<std::pair<std::string, double>> all;
    motion.u = balanced;
    Vector relevant_end(motion.u);
    relevant_end = u;
    for (const auto &contact : contacts)
      for (const auto &scalar : contact.scalars(relevant_end, motion.u))
        all.push_back(scalar);
    return all;
  }

  template class SolidSystem<2>;
  template class SolidSystem<3>;
} // namespace Stroma::Fem
