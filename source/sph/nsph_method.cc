#include <stroma/base/text.h>
#include <stroma/particles/lattice.h>
#include <stroma/sph/nsph_method.h>

#include "islands.h"

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    /// Largest norm of a velocity gradient times dt in a step.
    constexpr double largest_strain = .2;

    /// Part of the longest step that moves and strains allow which is proposed for the next one.
    constexpr double proposed = .9;

    /// Part of the loads of a scene that nothing holds which may be left over: particles sum them up only nearly.
    constexpr double smallest_net_load = .02;

    /// Solves of a step with contacts: beyond these the step is cut.
    constexpr unsigned int max_rounds = 12;

    /// Of Alexander's SDIRK 2.
    const double gamma = 1. - std::sqrt(.5);

    template <int dim>
    std::string
    place(const dealii::Point<dim> &X)
    {
      std::string text;
      for (unsigned int d = 0; d < dim; ++d)
        text += (d == 0 ? "" : ", ") + brief(X[d]);
      return text;
    }

    template <int dim>
    std::string
    where_of_body(const Scene<dim> &scene, const std::string &name)
    {
      for (const auto &rigid : scene.rigid_bodies)
        if (rigid.name == name)
          return rigid.where;
      return "section Bodies";
    }

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

  template <int dim>
  NsphMethod<dim>::NsphMethod(Parameters &p, const Scene<dim> &scene, const Solvers::StepSettings &steps,
                              Timers &timers)
    : ParticleMethod<dim>(p, scene, Dynamics::overdamped, steps.end_time, timers)
  {
    linear_settings.tolerance = 1e-6;
    const bool is_held        = !scene.supports.empty() || std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                                                       [](const auto &body) { return body.rigid; });
    if (!is_held)
      linear_settings.preconditioner = Solvers::Preconditioner::jacobi;
    {
      const auto section = p.section("Linear solver", "conjugate gradients");
      linear_settings.add(p);
      if (!is_held && linear_settings.preconditioner == Solvers::Preconditioner::amg)
        throw UserError(p.where("Preconditioner"),
                        "multigrid needs material that is held somewhere; without a support set "
                        "'Preconditioner = jacobi'");
    }
    const double move = (this->settings.published() ? 1. : this->settings.largest_move) *
                        this->settings.arrangement.spacing;
    for (const auto &rigid : scene.rigid_bodies)
      if (rigid.resistance.largest_approach > move)
        throw UserError(rigid.where, "rigid body '" + rigid.name + "' has a 'Largest approach' of " +
                                       brief(rigid.resistance.largest_approach) +
                                       " m, but steps are cut to moves of 'NSPH/Largest move' times the spacing, " +
                                       brief(move) + " m; reduce it");
    const double limit = explicit_limit(scene, this->system->constitutions, this->settings);
    if (!is_implicit() && std::max(steps.initial_step, steps.largest_step) > limit)
      throw UserError(this->settings.where_stress_update,
                      "explicit stresses are stable up to steps of " + brief(limit) +
                        " s (see 'Stress update'), but 'Time/Initial step' is " + brief(steps.initial_step) +
                        " s and 'Largest step' " + brief(steps.largest_step) +
                        " s; reduce them or set 'Stress update = implicit'");
  }

  template <int dim>
  double
  NsphMethod<dim>::explicit_limit(const Scene<dim> &scene, const std::vector<Constitution> &constitutions,
                                  const Settings &settings)
  {
    double limit = std::numeric_limits<double>::max();
    for (unsigned int m = 0; m < constitutions.size(); ++m)
      {
        const bool  central = scene.media[m].viscous_operator == Materials::ViscousOperator::central;
        const auto &law     = constitutions[m];
        limit               = std::min(limit, 2. * (central ? 3. : 1.) * law.mu / law.p_wave_modulus());
        if (law.G > 0.)
          limit = std::min(limit, 2. * law.mu / law.G);
        if (law.G > 0. && !central && !settings.published())
          limit = std::min(limit, 1.5 * law.mu / (settings.stabilisation * law.G));
        // One-sided gradients see what plane waves do not: dilatation in all directions, and that by fewer neighbours.
        if (!settings.published() && Interfaces<dim>::exist_among(constitutions))
          limit = std::min(central ? 10. / 3. * law.mu / law.K : law.mu / law.p_wave_modulus(), limit);
      }
    return limit;
  }

  template <int dim>
  void
  NsphMethod<dim>::prepare(const Output::ArchiveReader *archive)
  {
    A                        = std::make_unique<StepOperator<dim>>(*this->system);
    linear_solver            = std::make_unique<Solvers::LinearSolver>(linear_settings);
    const auto &system       = *this->system;
    const bool  all_periodic = std::all_of(this->scene.periodic.begin(), this->scene.periodic.end(),
                                           [](bool p) { return p; });
    if (!system.is_supported() && !all_periodic)
      throw UserError("section Supports",
                      "nothing holds the material, and without inertia forces alone do not tell how it "
                      "moves as a whole; clamp a side or a layer, or solve with 'Method = sph'");
    if (const auto islands = find_islands(system); !islands.body.empty())
      throw UserError(
        where_of_body(this->scene, islands.body),
        "nothing holds rigid body '" + islands.body +
          "', which the balance of forces moves, and without inertia forces alone do not tell how; give it a 'Drag' " +
          "or, if it touches nothing at the start, a 'Largest approach', hold what it touches, or solve with 'Method = sph'");
    else if (islands.n_particles > 0)
      {
        const int body = body_at(this->scene, islands.X);
        throw UserError(body < 0 ? "section Bodies" : this->scene.bodies[body].where,
                        std::to_string(islands.n_particles) + " particles" +
                          (body < 0 ? "" : " of body '" + this->scene.bodies[body].name + "'") + ", one of them at " +
                          place(islands.X) +
                          " m, touch nothing that is held, and without inertia nothing tells how they "
                          "move; hold them too, take a larger 'Spacing', or solve with 'Method = sph'");
      }
    n_searches = system.neighbours->n_rebuilds;
    if (!system.is_supported() && this->time == 0.)
      check_balance();
    if (!is_implicit())
      Log::line("NSPH: explicit stresses are stable up to steps of " +
                brief(explicit_limit(this->scene, system.constitutions, this->settings)) + " s");
    if (archive)
      restore_solver(*archive);
  }

  /// Throws UserError where loads have a sum and nothing takes it up: in a scene that is periodic all around.
  template <int dim>
  void
  NsphMethod<dim>::check_balance() const
  {
    auto &system = *this->system;
    for (const double part : {0., .25, .5, .75, 1.})
      {
        std::vector<double> sums(dim + 1, 0.); // of forces, and of their sizes
        for (const auto &f : system.loads->force(system.particles, part * this->end_time))
          {
            for (unsigned int c = 0; c < dim; ++c)
              sums[c] += f[c];
            sums[dim] += f.norm();
          }
        dealii::Utilities::MPI::sum(sums, this->scene.comm, sums);
        for (unsigned int c = 0; c < dim; ++c)
          if (std::abs(sums[c]) > smallest_net_load * sums[dim])
            throw UserError("section Loads",
                            "at t = " + brief(part * this->end_time) + " s the loads sum up to " +
                              brief(system.thickness() * sums[c]) + " N along " + "xyz"[c] +
                              ", and nothing holds the scene, which repeats in all directions; take the mean "
                              "out of the loads, hold something, or solve with 'Method = sph'");
      }
  }

  /// That of the system; detached where something has come loose since the last search for neighbours.
  template <int dim>
  StepStatus
  NsphMethod<dim>::update_geometry()
  {
    auto      &system = *this->system;
    const auto status = system.update_geometry();
    if (status != StepStatus::ok)
      return status;
    for (unsigned int m = 0; system.bodies && m < system.movers.size(); ++m)
      if (system.bodies->moves(m) && !system.bodies->touches(m) && !system.bodies->resists(m))
        {
          Log::line("  rigid body '" + system.movers[m].name +
                    "' touches nothing any more; give it a 'Drag' or a 'Largest approach'");
          return StepStatus::detached;
        }
    if (system.neighbours->n_rebuilds == n_searches)
      return StepStatus::ok;
    if (!all_is_held())
      return StepStatus::detached;
    n_searches = system.neighbours->n_rebuilds;
    return StepStatus::ok;
  }

  /// Whether nothing has come loose, which is told of. Collective.
  template <int dim>
  bool
  NsphMethod<dim>::all_is_held() const
  {
    const auto islands = find_islands(*this->system);
    if (!islands.body.empty())
      Log::line("  rigid body '" + islands.body + "' touches nothing that is held any more");
    else if (islands.n_particles > 0)
      Log::line("  " + std::to_string(islands.n_particles) +
                " particles touch nothing that is held any more, one of them from " + place(islands.X) + " m");
    return islands.body.empty() && islands.n_particles == 0;
  }

  /// The longest step from the state with velocities @p v that moves and strains are likely to allow [s].
  template <int dim>
  double
  NsphMethod<dim>::next_step(const Velocities &v) const
  {
    const auto &system  = *this->system;
    double      fastest = system.fastest_body();
    for (unsigned int i = 0; i < system.particles.n_owned; ++i)
      fastest = std::max(fastest, v[i].norm());
    const double largest_move = this->settings.published() ? 1. : this->settings.largest_move;
    double       rate         = fastest / (this->settings.arrangement.spacing * largest_move);
    rate = std::max(rate, system.largest_gradient() / (this->settings.published() ? 1. : largest_strain));
    rate = dealii::Utilities::MPI::max(rate, this->scene.comm);
    return rate > 0. ? proposed / rate : std::numeric_limits<double>::max();
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::advance(const double t, const double t_next, StepWork &work)
  {
    auto        &system = *this->system;
    const double dt     = t_next - t;
    auto         status = update_geometry();
    if (status != StepStatus::ok)
      return status;
    system.set_step(t, t_next);
    Pair mean, end; // over the step, and at its end
    bool changed = false;
    status       = system.start_contacts(false, changed);
    if (status == StepStatus::ok && changed && !all_is_held())
      status = StepStatus::detached;
    work.hardest_solve = 1;
    if (status == StepStatus::ok)
      status = solve_with_contacts(mean, end, t, t_next, work);
    if (status == StepStatus::ok)
      status = commit(mean, end, dt, work);
    if (status != StepStatus::ok)
      system.restore_contacts();
    else
      this->time = t_next, this->collect_scalars(t_next);
    return status;
  }

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
        if (!all_is_held())
          return StepStatus::detached;
        system.set_step(t, t_next);
      }
    return StepStatus::moved_too_far;
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::commit(Pair &mean, Pair &end, const double dt, StepWork &work)
  {
    auto      &system = *this->system;
    const auto scope  = this->timers.scope("stress");
    system.set_gradient(mean.particles);
    const bool published = this->settings.published();
    const auto status    = system.check(mean.particles, dt, published ? 1. : this->settings.largest_move,
                                     published ? 1. : largest_strain);
    if (status != StepStatus::ok)
      return status;
    const bool in_balance = before.step > 0.; // as velocities at the start are not
    before                = {std::move(system.particles.v), dt, in_balance ? system.neighbours->n_orders : 0};
    work.longest_next     = next_step(end.particles);
    system.commit(mean.particles, dt);
    end.particles.resize(system.particles.size()); // without wall points
    system.particles.v = std::move(end.particles);
    system.shift(mean.particles, dt);
    return StepStatus::ok;
  }

  /// Loads, stresses and hourglass control of the state.
  template <int dim>
  typename NsphMethod<dim>::Pair
  NsphMethod<dim>::state_forces(const double load_time)
  {
    Pair driving;
    this->system->state_forces(driving.particles, load_time);
    if (this->system->bodies)
      driving.bodies = this->system->state_forces_on_bodies(load_time);
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
    end.particles = first_guess(share * dt);
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
  typename NsphMethod<dim>::Velocities
  NsphMethod<dim>::first_guess(const double ahead) const
  {
    Velocities v = this->system->particles.v;
    if (before.order == this->system->neighbours->n_orders)
      for (unsigned int i = 0; i < this->system->particles.n_free; ++i)
        v[i] += ahead / before.step * (v[i] - before.v[i]);
    return v;
  }

  template <int dim>
  void
  NsphMethod<dim>::prepare_operator(const double dt)
  {
    A->set_step(dt);
    const auto order = this->system->neighbours->n_orders;
    if (linear_settings.preconditioner == Solvers::Preconditioner::amg && order != order_of_solver)
      linear_solver->set_near_null_space(A->near_null_space());
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

  /// The norm that solves are relative to: the largest of what acts.
  template <int dim>
  double
  NsphMethod<dim>::scale(const Pair &driving, const Pair &resisting) const
  {
    const auto &system = *this->system;
    const auto &comm   = this->scene.comm;
    const auto  all    = [](const double of_particles, const std::vector<double> &of_bodies) {
      double sum = of_particles * of_particles;
      for (const double f : of_bodies)
        sum += f * f;
      return std::sqrt(sum);
    };
    const auto loads = system.bodies ? system.bodies->last_loads() : std::vector<double>();
    return std::max({all(norm(system.loads->last_force(), comm), loads),
                     all(norm(driving.particles, comm), driving.bodies),
                     all(norm(resisting.particles, comm), resisting.bodies)});
  }

  template <int dim>
  StepStatus
  NsphMethod<dim>::solve(Pair &v, const Pair &driving, StepWork &work)
  {
    const auto &system = *this->system;
    // What is left of the balance with the velocities of the first guess, those imposed included.
    auto               left   = resistance(v);
    const double       size   = scale(driving, left);
    Vector             r      = A->new_vector(), change(r);
    const unsigned int n      = system.particles.n_free;
    auto *const        values = reinterpret_cast<dealii::Tensor<1, dim> *>(r.begin());
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int c = 0; c < dim; ++c)
        values[i][c] = system.is_held(i, c) ? 0. : driving.particles[i][c] + left.particles[i][c];
    for (unsigned int u = 0; u < left.bodies.size(); ++u)
      left.bodies[u] += driving.bodies[u];
    A->set_bodies(r, left.bodies);
    if (!system.is_supported())
      remove_mean(r);

    const auto result = linear_solver->solve(*A, change, r, linear_settings.tolerance * size);
    work.linear_iterations += result.iterations;
    work.residual_evaluations += 1;
    if (!result.converged)
      return StepStatus::linear_failed;
    if (!system.is_supported())
      remove_mean(change);
    const auto *const changes = reinterpret_cast<const dealii::Tensor<1, dim> *>(change.begin());
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

  template <int dim>
  void
  NsphMethod<dim>::remove_mean(Vector &r) const
  {
    dealii::Tensor<1, dim> sum;
    const unsigned int     n      = this->system->particles.n_free;
    auto *const            values = reinterpret_cast<dealii::Tensor<1, dim> *>(r.begin());
    for (unsigned int i = 0; i < n; ++i)
      sum += values[i];
    sum = dealii::Utilities::MPI::sum(sum, this->scene.comm);
    for (unsigned int i = 0; i < n; ++i)
      values[i] -= sum / double(this->system->n_free);
  }

  template <int dim>
  void
  NsphMethod<dim>::describe_stepping(Output::Summary &summary) const
  {
    summary.method = "nsph";
    (is_implicit() ? summary.used : summary.left_out).push_back("stiffness in the velocity system");
    summary.results["explicit_step_limit_s"] = explicit_limit(this->scene, this->system->constitutions, this->settings);
  }

  template class NsphMethod<2>;
  template class NsphMethod<3>;
} // namespace Stroma::Sph
