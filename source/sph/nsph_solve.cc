// The solves of a step: its stages, and rounds of these until no contact changes.

#include <stroma/sph/nsph_method.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    /// Solves of a step with contacts: beyond these the step is cut.
    constexpr unsigned int max_rounds = 12;

    /// A load on a body over the largest of what acts, below which no solve has to know it.
    constexpr double negligible = 1e-8;

    /// Residual over the largest of what acts, below which rounding lets no solve get.
    constexpr double attainable = 1e-12;

    /// Of Alexander's SDIRK 2.
    const double gamma = 1. - std::sqrt(.5);

    template <int dim>
    double
    norm(const std::vector<dealii::Tensor<1, dim>> &f, const MPI_Comm comm)
    {
      double sum = 0.;
      for (const auto &f_i : f)
        sum += f_i.norm_square();
      return std::sqrt(dealii::Utilities::MPI::sum(sum, comm));
    }
  } // namespace

  /// Repeats the solve until no particle enters or leaves a contact.
  template <int dim>
  StepStatus
  NsphMethod<dim>::solve_with_contacts(Pair &mean, Pair &end, const double t, const double t_next, StepWork &work)
  {
    auto        &system = *this->system;
    const double dt     = t_next - t;
    for (unsigned int round = 0; round < max_rounds; ++round)
      {
        StepStatus status;
        {
          const auto scope = this->timers.scope("solve");
          work.newton_iterations += 1;
          status = solve_stages(mean, end, dt, work);
        }
        if (status == StepStatus::ok && system.bodies)
          {
            system.take_body_velocities(mean.bodies, end.bodies);
            system.impose(mean.particles);
          }
        bool changed = false;
        if (status == StepStatus::ok && system.contacts)
          status = system.change_contacts(mean.particles, end.particles, dt, changed);
        if (status != StepStatus::ok || !changed)
          return status;
        status = find_islands();
        if (status != StepStatus::ok)
          return status;
        system.set_step(t, t_next);
      }
    return StepStatus::moved_too_far;
  }

  /// Loads, stresses and hourglass control of the state.
  template <int dim>
  typename NsphMethod<dim>::Pair
  NsphMethod<dim>::state_forces(const double load_time)
  {
    Pair driving;
    this->system->state_forces(driving.particles, load_time);
    if (this->system->bodies)
      {
        driving.bodies  = this->system->state_forces_on_bodies(load_time);
        loads_on_bodies = this->system->bodies->loads(load_time);
      }
    return driving;
  }

  /// Adds what the stress changes by in @p dt with velocities @p v.
  template <int dim>
  void
  NsphMethod<dim>::add_stress_change(Pair &driving, const Velocities &v, const double dt) const
  {
    const auto &system = *this->system;
    Velocities  increment(driving.particles.size());
    system.elasticity->combine(1., 0.);
    system.elasticity->add_stiffness_force(increment, v);
    for (unsigned int i = 0; i < increment.size(); ++i)
      driving.particles[i] += dt * increment[i];
    if (!system.bodies)
      return;
    const auto on_bodies = system.bodies->forces(
      [&](const unsigned int i, const auto &add) { system.elasticity->visit_wall_responses(i, v, add); });
    for (unsigned int u = 0; u < on_bodies.size(); ++u)
      driving.bodies[u] += dt * on_bodies[u];
  }

  /// Lets the places of walls go with the bodies at @p q.
  template <int dim>
  void
  NsphMethod<dim>::set_bodies(Pair &v, const std::vector<double> &q) const
  {
    auto change = q;
    for (unsigned int u = 0; u < q.size(); ++u)
      change[u] -= v.bodies[u];
    this->system->bodies->add_velocities(v.particles, change);
    this->system->pairs.let_slide(v.particles);
    v.bodies = q;
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::solve_stages(Pair &mean, Pair &end, const double dt, StepWork &work)
  {
    auto        &system  = *this->system;
    const bool   two     = is_implicit() && this->settings.scheme == Solvers::SchemeName::sdirk2;
    const double share   = two ? gamma : 1.; // of the step, in each stage
    auto         driving = state_forces(this->time + share * dt);
    if (system.bodies)
      system.bodies->set_resistance(this->time + share * dt, dt);
    prepare_operator(is_implicit() ? share * dt : 0.);
    end.particles = system.particles.v;
    history.extrapolate(end.particles, system.particles.n_free, share * dt, system.neighbours->n_orders);
    system.impose(end.particles);
    const auto last = system.bodies ? system.bodies->unknowns_of(system.twists) : std::vector<double>();
    end.bodies      = last;
    auto status     = solve(end, driving, work);
    mean            = end;
    if (!two || status != StepStatus::ok)
      return status;

    // Alexander's second stage, with the stress that the first leaves; first guess on the line through what is known.
    const double further = 1. / gamma - 1.;
    for (unsigned int i = 0; i < system.particles.n_free; ++i) // what is imposed follows
      end.particles[i] += further * (mean.particles[i] - system.particles.v[i]);
    system.impose(end.particles);
    end.bodies = last;
    auto guess = mean.bodies;
    for (unsigned int u = 0; u < guess.size(); ++u)
      guess[u] += further * (mean.bodies[u] - last[u]);
    if (system.bodies)
      set_bodies(end, guess);
    driving = state_forces(this->time + dt);
    add_stress_change(driving, mean.particles, (1. - gamma) * dt);
    prepare_operator(share * dt);
    status = solve(end, driving, work);
    for (unsigned int i = 0; i < end.particles.size(); ++i)
      mean.particles[i] = (1. - gamma) * mean.particles[i] + gamma * end.particles[i];
    for (unsigned int u = 0; u < end.bodies.size(); ++u)
      mean.bodies[u] = (1. - gamma) * mean.bodies[u] + gamma * end.bodies[u];
    return status;
  }

  template <int dim>
  void
  NsphMethod<dim>::prepare_operator(const double dt)
  {
    A->set_step(dt);
    const auto order = this->system->neighbours->n_orders;
    if (order != order_of_solver)
      {
        linear_solver->forget();
        if (linear_settings.preconditioner == Solvers::Preconditioner::amg)
          linear_solver->set_near_null_space(A->near_null_space());
      }
    order_of_solver = order;
  }

  /// -A v of all velocities, with the drag of bodies.
  template <int dim>
  typename NsphMethod<dim>::Pair
  NsphMethod<dim>::resistance(const Pair &v) const
  {
    Pair resisting;
    A->force(resisting.particles, v.particles);
    const auto &bodies = this->system->bodies;
    if (!bodies)
      return resisting;
    resisting.bodies = A->force_on_bodies(v.particles);
    auto twists      = bodies->twists_of(v.bodies);
    this->system->add_given(twists);
    const auto drag = bodies->drag_force(twists);
    for (unsigned int u = 0; u < drag.size(); ++u)
      resisting.bodies[u] += drag[u];
    return resisting;
  }

  /// Bound of the residual: relative to the largest of what acts, but to no more than the load on any body. A load may be far
  /// smaller than the forces of stiff material, which nearly cancel; relative to those, its body would go anywhere.
  template <int dim>
  double
  NsphMethod<dim>::largest_residual(const Pair &driving, const Pair &resisting) const
  {
    const auto &system = *this->system;
    const auto &comm   = this->scene.comm;
    const auto  all    = [](const double of_particles, const std::vector<double> &of_bodies) {
      double sum = of_particles * of_particles;
      for (const double f : of_bodies)
        sum += f * f;
      return std::sqrt(sum);
    };
    const double largest = std::max({all(norm(system.loads->last_force(), comm), loads_on_bodies),
                                     all(norm(driving.particles, comm), driving.bodies),
                                     all(norm(resisting.particles, comm), resisting.bodies)});
    const double least   = system.bodies ? system.bodies->least_of(loads_on_bodies) : largest;
    const double scale   = std::clamp(least, negligible * largest, largest);
    return std::max(linear_settings.tolerance * scale, std::min(linear_settings.tolerance, attainable) * largest);
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::solve(Pair &v, const Pair &driving, StepWork &work)
  {
    auto &system = *this->system;
    if (islands_are_driven())
      return StepStatus::detached;
    if (!islands->all().empty())
      {
        islands->remove_rigid_motions(v.particles.data());
        system.neighbours->update_ghosts(v.particles);
        system.pairs.let_slide(v.particles);
      }
    // What is left of the balance with the velocities of the first guess, those imposed included.
    auto         left         = resistance(v);
    const double bound        = largest_residual(driving, left);
    system.residual           = bound;
    Vector             r      = A->new_vector(), change(r);
    const unsigned int n      = system.particles.n_free;
    auto *const        values = reinterpret_cast<dealii::Tensor<1, dim> *>(r.begin());
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int c = 0; c < dim; ++c)
        values[i][c] = system.is_held(i, c) ? 0. : driving.particles[i][c] + left.particles[i][c];
    for (unsigned int u = 0; u < left.bodies.size(); ++u)
      left.bodies[u] += driving.bodies[u];
    islands->remove_rigid_motions(values);
    A->set_bodies(r, left.bodies);
    if (!system.is_supported())
      remove_mean(r);

    const auto result = linear_solver->solve(*A, change, r, bound);
    work.linear_iterations += result.iterations;
    work.residual_evaluations += 1;
    if (!result.converged)
      return StepStatus::linear_failed;
    if (!system.is_supported())
      remove_mean(change);
    auto *const changes = reinterpret_cast<dealii::Tensor<1, dim> *>(change.begin());
    islands->remove_rigid_motions(changes);
    for (unsigned int i = 0; i < n; ++i)
      v.particles[i] += changes[i];
    system.neighbours->update_ghosts(v.particles);
    if (system.bodies)
      {
        auto q = A->of_bodies(change);
        for (unsigned int u = 0; u < q.size(); ++u)
          q[u] += v.bodies[u];
        set_bodies(v, q);
      }
    system.pairs.let_slide(v.particles);
    return StepStatus::ok;
  }

  /// Of what hangs together with the particle of the lowest id.
  template <int dim>
  void
  NsphMethod<dim>::remove_mean(Vector &r) const
  {
    dealii::Tensor<1, dim> sum;
    const unsigned int     n      = this->system->particles.n_free;
    auto *const            values = reinterpret_cast<dealii::Tensor<1, dim> *>(r.begin());
    for (unsigned int i = 0; i < n; ++i)
      if (!islands->has(i))
        sum += values[i];
    sum = dealii::Utilities::MPI::sum(sum, this->scene.comm);
    for (unsigned int i = 0; i < n; ++i)
      if (!islands->has(i))
        values[i] -= sum / double(this->system->n_free - islands->n_particles());
  }

  template StepStatus                   NsphMethod<2>::solve_with_contacts(Pair &, Pair &, double, double, StepWork &);
  template typename NsphMethod<2>::Pair NsphMethod<2>::state_forces(double);
  template void                         NsphMethod<2>::add_stress_change(Pair &, const Velocities &, double) const;
  template void                         NsphMethod<2>::set_bodies(Pair &, const std::vector<double> &) const;
  template StepStatus                   NsphMethod<2>::solve_stages(Pair &, Pair &, double, StepWork &);
  template void                         NsphMethod<2>::prepare_operator(double);
  template typename NsphMethod<2>::Pair NsphMethod<2>::resistance(const Pair &) const;
  template double                       NsphMethod<2>::largest_residual(const Pair &, const Pair &) const;
  template StepStatus                   NsphMethod<2>::solve(Pair &, const Pair &, StepWork &);
  template void                         NsphMethod<2>::remove_mean(Vector &) const;
  template StepStatus                   NsphMethod<3>::solve_with_contacts(Pair &, Pair &, double, double, StepWork &);
  template typename NsphMethod<3>::Pair NsphMethod<3>::state_forces(double);
  template void                         NsphMethod<3>::add_stress_change(Pair &, const Velocities &, double) const;
  template void                         NsphMethod<3>::set_bodies(Pair &, const std::vector<double> &) const;
  template StepStatus                   NsphMethod<3>::solve_stages(Pair &, Pair &, double, StepWork &);
  template void                         NsphMethod<3>::prepare_operator(double);
  template typename NsphMethod<3>::Pair NsphMethod<3>::resistance(const Pair &) const;
  template double                       NsphMethod<3>::largest_residual(const Pair &, const Pair &) const;
  template StepStatus                   NsphMethod<3>::solve(Pair &, const Pair &, StepWork &);
  template void                         NsphMethod<3>::remove_mean(Vector &) const;
} // namespace Stroma::Sph
