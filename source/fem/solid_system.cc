#include <stroma/fem/solid_system.h>

#include <deal.II/lac/trilinos_sparsity_pattern.h>

#include <cmath>
#include <limits>

namespace Stroma::Fem
{
  template <int dim>
  SolidSystem<dim>::SolidSystem(const Scene<dim> &scene, const Settings<dim> &settings, const Mesh<dim> &mesh,
                                Unknowns<dim> &unknowns, Timers &timers)
    : scene(scene)
    , settings(settings)
    , mesh(mesh)
    , unknowns(unknowns)
    , timers(timers)
    , comm(scene.comm)
    , cell_forces(scene, settings, unknowns.fe, mesh.mapping())
    , loads(scene, settings, mesh, {unknowns.dofs, unknowns.fe, unknowns.ties, unknowns.owned}, unknowns.loaded_singly())
    , viscous(std::any_of(scene.media.begin(), scene.media.end(), [](const auto &m) { return m.is_viscous(); }))
    , held_target(unknowns.held.size(), 0.)
    , unbalanced(unknowns.owned, comm)
    , tied_u(unknowns.owned, comm)
    , relevant_u(unknowns.owned, unknowns.relevant, comm)
    , assembled_factors{{std::nan(""), 0., 0.}}
  {
    if (!scene.loads.empty())
      external.reinit(unknowns.owned, comm);
    if (viscous || settings.inertia)
      relevant_v.reinit(unknowns.owned, unknowns.relevant, comm);
    if (settings.inertia)
      relevant_a.reinit(unknowns.owned, unknowns.relevant, comm);
    if (!scene.contacts.empty())
      touching.reinit(unknowns.owned, comm);
    for (const auto &contact : scene.contacts)
      contacts.emplace_back(scene, contact, settings, mesh, unknowns);
    history.assign(std::size_t(mesh.triangulation.n_locally_owned_active_cells()) * cell_forces.n_points() *
                     cell_forces.n_history(),
                   0.);
  }

  template <int dim>
  void
  SolidSystem<dim>::set_stage(const Solvers::Stage &next, const double t_next, const double step, const Vector &start)
  {
    stage = next;
    dt    = step;
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
      relevant_u = start;
    else if (!stage.is_last)
      relevant_v = stage.v_known;
    for (std::size_t i = 0; i < held_target.size(); ++i)
      {
        const auto &held = unknowns.held[i];
        held_target[i]   = 0.;
        if (held.support == scene.supports.size())
          continue;
        const auto &g = scene.supports[held.support].displacement;
        if (stage.is_last)
          held_target[i] = g.value(held.X, t_next, held.component);
        else
          held_target[i] = (g.rate(held.X, stage.t, held.component, dt / 1024.) - relevant_v(held.dof)) / stage.v_factor;
        if (stage.start_weight > 0.)
          held_target[i] += stage.start_weight * (relevant_u(held.dof) - held_target[i]);
      }
  }

  template <int dim>
  void
  SolidSystem<dim>::reinit_matrix(Matrix &K) const
  {
    const auto                                   constraints = unknowns.constraints({});
    dealii::TrilinosWrappers::SparsityPattern    pattern(unknowns.owned, unknowns.owned, unknowns.relevant, comm);
    Dofs dofs(unknowns.fe.n_dofs_per_cell());
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          constraints.add_entries_local_to_global(dofs, pattern, false);
        }
    for (dealii::types::global_dof_index i = unknowns.dofs.n_dofs(); i < unknowns.size(); ++i)
      if (unknowns.owned.is_element(i))
        pattern.add(i, i);
    for (const auto &contact : contacts)
      contact.add_pattern(pattern, constraints);
    pattern.compress();
    K.reinit(pattern);
  }

  /// Vectors with ghosts of u, v and a of the stage.
  template <int dim>
  void
  SolidSystem<dim>::find_motion(const Vector &u)
  {
    tied_u = u;
    unknowns.distribute(tied_u);
    relevant_u             = tied_u;
    const auto find_linear = [&](Vector &relevant, const double factor, const Vector &known) {
      Vector value(tied_u);
      value *= factor;
      if (known.size() > 0)
        value += known;
      unknowns.distribute(value);
      relevant = value;
    };
    if (viscous)
      find_linear(relevant_v, stage.v_factor, stage.v_known);
    if (settings.inertia)
      find_linear(relevant_a, stage.a_factor, stage.a_known);
  }

  template <int dim>
  void
  SolidSystem<dim>::gather(const Dofs &dofs, Motion &m) const
  {
    m.u.resize(dofs.size());
    relevant_u.extract_subvector_to(dofs, m.u);
    if (relevant_v.size() > 0)
      {
        m.v.resize(dofs.size());
        relevant_v.extract_subvector_to(dofs, m.v);
      }
    if (settings.inertia)
      {
        m.a.resize(dofs.size());
        relevant_a.extract_subvector_to(dofs, m.a);
      }
    m.v_factor = stage.v_factor;
    m.a_factor = settings.inertia ? stage.a_factor : 0.;
    m.dt       = dt;
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

  /// Minus the forces of all cells in the motion found, into unbalanced.
  template <int dim>
  StepStatus
  SolidSystem<dim>::add_cell_forces(double &squares)
  {
    unbalanced = 0.;
    energy     = 0.;
    squares    = 0.;
    dealii::Vector<double> f(unknowns.fe.n_dofs_per_cell());
    const StepStatus       status = for_owned_cells([&](const auto &, const Dofs &dofs) {
      const StepStatus evaluated = cell_forces.force(motion, f);
      if (evaluated == StepStatus::ok)
        {
          energy += cell_forces.strain_energy();
          squares += cell_forces.summed_force_square(motion);
          f *= -1.;
          unknowns.ties.distribute_local_to_global(f, dofs, unbalanced);
        }
      return evaluated;
    });
    unbalanced.compress(dealii::VectorOperation::add);
    return reduce(status, comm);
  }

  template <int dim>
  StepStatus
  SolidSystem<dim>::evaluate_end(const Solvers::Motion &end, const double t)
  {
    stage         = Solvers::Stage();
    stage.v_known = end.v;
    stage.a_known = end.a;
    find_motion(end.u);
    double           squares;
    const StepStatus status = add_cell_forces(squares);
    if (touching.size() > 0)
      unbalanced += touching;
    if (!scene.loads.empty())
      {
        loads.assemble(t, external);
        unbalanced += external;
      }
    return status;
  }

  template <int dim>
  StepStatus
  SolidSystem<dim>::residual(Vector &r, const Vector &u)
  {
    const auto scope = timers.scope("residual");
    find_motion(u);
    double           squares;
    const StepStatus status = add_cell_forces(squares);
    if (status != StepStatus::ok)
      return status;
    internal_force_norm = unbalanced.l2_norm();
    if (!std::isfinite(internal_force_norm))
      return StepStatus::not_finite;
    find_round_off(squares);
    if (!contacts.empty())
      {
        touching = 0.;
        for (const auto &contact : contacts)
          contact.add_force(touching, relevant_u);
        touching.compress(dealii::VectorOperation::add);
        unbalanced += touching;
      }
    if (!scene.loads.empty())
      unbalanced += external;
    r = unbalanced;
    for (const auto &held : unknowns.held)
      if (unknowns.owned.is_element(held.dof))
        r(held.dof) = 0.;
    r.compress(dealii::VectorOperation::insert);
    return StepStatus::ok;
  }

  template <int dim>
  void
  SolidSystem<dim>::find_round_off(const double squares)
  {
    double summed = 2. * std::sqrt(dealii::Utilities::MPI::sum(squares, comm));
    for (const auto &contact : contacts)
      summed += contact.summed_force(relevant_u);
    if (!scene.loads.empty())
      summed += external.l2_norm();
    round_off_norm = std::numeric_limits<double>::epsilon() * summed;
  }

  /// Whether the tangent is the one assembled last: a linear system, the same stage factors, nothing to lift.
  template <int dim>
  bool
  SolidSystem<dim>::is_assembled(const std::vector<double> &jump) const
  {
    if (settings.kinematics != Kinematics::small || !contacts.empty() ||
        assembled_factors != std::array<double, 3>{{stage.v_factor, stage.a_factor, dt}})
      return false;
    const int jumps = std::any_of(jump.begin(), jump.end(), [](const double j) { return j != 0.; });
    return dealii::Utilities::MPI::max(jumps, comm) == 0;
  }

  template <int dim>
  StepStatus
  SolidSystem<dim>::tangent(Matrix &K, Vector &r, const Vector &u)
  {
    const auto scope = timers.scope("stiffness");
    find_motion(u);
    std::vector<double> jump(held_target.size());
    for (std::size_t i = 0; i < jump.size(); ++i)
      jump[i] = held_target[i] - relevant_u(unknowns.held[i].dof);
    if (is_assembled(jump))
      return StepStatus::ok;
    K                 = 0.;
    assembled_factors = {{stage.v_factor, stage.a_factor, dt}};
    const auto constraints = unknowns.constraints(jump);

    dealii::FullMatrix<double> K_cell(unknowns.fe.n_dofs_per_cell());
    dealii::Vector<double>     zero(K_cell.m());
    const StepStatus           status = for_owned_cells([&](const auto &, const Dofs &dofs) {
      const StepStatus evaluated = cell_forces.stiffness(motion, K_cell);
      if (evaluated == StepStatus::ok)
        constraints.distribute_local_to_global(K_cell, zero, dofs, K, r, true);
      return evaluated;
    });
    for (const auto &contact : contacts)
      contact.add_stiffness(K, r, relevant_u, constraints);
    K.compress(dealii::VectorOperation::add);
    r.compress(dealii::VectorOperation::add);
    // Rigid bodies that are held, or touch nothing, have rows of their own.
    double scale = 0;
    for (dealii::types::global_dof_index i = unknowns.dofs.n_dofs(); i < unknowns.size(); ++i)
      if (unknowns.owned.is_element(i) && K.diag_element(i) == 0.)
        {
          scale = scale == 0. ? scene.materials.front()->p_wave_modulus() * scene.thickness : scale;
          K.set(i, i, scale);
          r(i) = constraints.is_constrained(i) ? scale * constraints.get_inhomogeneity(i) : 0.;
        }
    K.compress(dealii::VectorOperation::insert);
    r.compress(dealii::VectorOperation::insert);
    return reduce(status, comm);
  }

  template <int dim>
  void
  SolidSystem<dim>::start_step(const Vector &u)
  {
    tied_u = u;
    unknowns.distribute(tied_u);
    relevant_u = tied_u;
    for (auto &contact : contacts)
      contact.start_step(relevant_u);
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
    relevant_u = u;
    bool again = false;
    for (auto &contact : contacts)
      again |= contact.update(relevant_u);
    return again;
  }

  template <int dim>
  void
  SolidSystem<dim>::commit(const Vector &u, const Vector &v, const double step)
  {
    if (history.empty() && cell_forces.n_history() == 0)
      return;
    std::vector<double> next(history.size());
    std::size_t         place = 0;
    for_each_cell(u, v, [&](const auto &, SolidCell<dim> &forces, const Motion &m) {
      forces.new_history(m, next.data() + place);
      place += forces.n_points() * forces.n_history();
    }, step);
    history = next;
  }

  template <int dim>
  void
  SolidSystem<dim>::start_held(Vector &v, const double h) const
  {
    for (const auto &held : unknowns.held)
      if (unknowns.owned.is_element(held.dof))
        v(held.dof) = held.support < scene.supports.size() ?
                        scene.supports[held.support].displacement.rate(held.X, 0., held.component, -h) :
                        0.;
    v.compress(dealii::VectorOperation::insert);
  }

  template <int dim>
  StepStatus
  SolidSystem<dim>::initial_acceleration(Solvers::LinearSolver &solver, Matrix &K, Vector &a, const Vector &u, const Vector &v,
                                         const double h)
  {
    Vector r(a);
    stage.v_factor = stage.a_factor = 0.;
    stage.v_known                   = v;
    stage.a_known                   = new_vector();
    const StepStatus status         = residual(r, u);
    if (status != StepStatus::ok)
      return status;
    K                      = 0.;
    assembled_factors[0]   = std::nan("");
    std::vector<double> accelerations(unknowns.held.size(), 0.);
    for (std::size_t i = 0; i < accelerations.size(); ++i)
      if (const auto &held = unknowns.held[i]; held.support < scene.supports.size())
        {
          const auto g     = [&](const double t) { return scene.supports[held.support].displacement.value(held.X, t, held.component); };
          accelerations[i] = (2. * g(0.) - 5. * g(h) + 4. * g(2. * h) - g(3. * h)) / (h * h);
        }
    const auto constraints = unknowns.constraints(accelerations);
    dealii::FullMatrix<double>                   M_cell(unknowns.fe.n_dofs_per_cell());
    dealii::Vector<double>                       zero(M_cell.m());
    Dofs                       dofs(M_cell.m());
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          cell_forces.reinit(cell, nullptr);
          cell_forces.mass(M_cell);
          constraints.distribute_local_to_global(M_cell, zero, dofs, K, r, true);
        }
    K.compress(dealii::VectorOperation::add);
    r.compress(dealii::VectorOperation::add);
    for (dealii::types::global_dof_index i = unknowns.dofs.n_dofs(); i < unknowns.size(); ++i)
      if (unknowns.owned.is_element(i) && K.diag_element(i) == 0.)
        K.set(i, i, 1.);
    K.compress(dealii::VectorOperation::insert);
    const bool solved = solver.solve(K, a, r, 1e-12).converged;
    solver.forget();
    unknowns.distribute(a);
    return solved ? StepStatus::ok : StepStatus::linear_failed;
  }

  template <int dim>
  std::vector<dealii::Tensor<1, dim>>
  SolidSystem<dim>::reactions() const
  {
    std::vector<dealii::Tensor<1, dim>> total(scene.supports.size());
    for (const auto &held : unknowns.held)
      if (unknowns.owned.is_element(held.dof) && held.support < total.size())
        total[held.support][held.component] -= unbalanced(held.dof);
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
        for (const auto &held : unknowns.held)
          if (held.dof == unknowns.of_body(b, c) && held.support == scene.supports.size())
            scalars.emplace_back("reaction_" + scene.bodies[b].name + "_" + "xyz"[c] + "_N",
                                 dealii::Utilities::MPI::sum(unknowns.owned.is_element(held.dof) ? -unbalanced(held.dof) : 0., comm));
    return scalars;
  }

  template <int dim>
  double
  SolidSystem<dim>::strain_energy() const
  {
    return dealii::Utilities::MPI::sum(energy, comm);
  }

  template <int dim>
  double
  SolidSystem<dim>::kinetic_energy(const Vector &v)
  {
    Vector tied(v);
    unknowns.distribute(tied);
    relevant_a = tied;
    double                                       sum = 0;
    dealii::FullMatrix<double>                   M(unknowns.fe.n_dofs_per_cell());
    dealii::Vector<double>                       values(M.m());
    Dofs                       dofs(M.m());
    for (const auto &cell : unknowns.dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          relevant_a.extract_subvector_to(dofs.begin(), dofs.end(), values.begin());
          cell_forces.reinit(cell, nullptr);
          cell_forces.mass(M);
          sum += .5 * M.matrix_norm_square(values);
        }
    return dealii::Utilities::MPI::sum(sum, comm);
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  SolidSystem<dim>::contact_scalars(const Vector &u, const Vector &balanced)
  {
    std::vector<std::pair<std::string, double>> all;
    relevant_u = balanced;
    Vector relevant_end(relevant_u);
    relevant_end = u;
    for (const auto &contact : contacts)
      for (const auto &scalar : contact.scalars(relevant_end, relevant_u))
        all.push_back(scalar);
    return all;
  }

  template class SolidSystem<2>;
  template class SolidSystem<3>;
} // namespace Stroma::Fem
