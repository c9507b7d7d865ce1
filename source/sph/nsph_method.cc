#include <stroma/base/text.h>
#include <stroma/particles/lattice.h>
#include <stroma/sph/nsph_method.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    /// Largest norm of a velocity gradient times dt in a step.
    constexpr double largest_strain = .2;

    /// Part of the longest step that moves and strains allow which is proposed for the next one.
    constexpr double proposed = .9;

    /// Of the longest stable step, what is left where segments have stress but no friction across them. Measured on the indentation of Heck
    /// 2017: .47 is stable, .71 is not.
    constexpr double beside_segments = .5;

    /// Part of the loads of a scene that nothing holds which may be left over: particles sum them up only nearly.
    constexpr double smallest_net_load = .02;

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
      return scene.bodies.front().where;
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
      linear_settings.add(p, Solvers::MorePreconditioners::cholesky);
      if (!is_held && linear_settings.preconditioner != Solvers::Preconditioner::jacobi)
        throw UserError(p.where("Preconditioner"),
                        "this preconditioner needs material that is held somewhere; without a support set "
                        "'Preconditioner = jacobi'");
      if (dim == 3 && linear_settings.preconditioner == Solvers::Preconditioner::cholesky)
        throw UserError(p.where("Preconditioner"),
                        "an incomplete factor is for the plane, in space it takes too much memory; "
                        "set 'Preconditioner = amg'");
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
                        " s and 'Largest step' " + brief(steps.largest_step) + " s; reduce them" +
                        (this->settings.has_segments() ? "" : " or set 'Stress update = implicit'"));
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
    return settings.has_segments() ? beside_segments * limit : limit;
  }

  template <int dim>
  void
  NsphMethod<dim>::prepare(const Output::ArchiveReader *archive)
  {
    islands            = std::make_unique<Islands<dim>>(*this->system);
    A                  = std::make_unique<StepOperator<dim>>(*this->system, islands.get());
    linear_solver      = std::make_unique<Solvers::LinearSolver>(linear_settings);
    const auto &system = *this->system;
    linear_solver->set_symmetric(!(system.bodies && system.pairs.has_segments())); // see BodyBalance
    const bool all_periodic = std::all_of(this->scene.periodic.begin(), this->scene.periodic.end(),
                                          [](bool p) { return p; });
    if (!system.is_supported() && !all_periodic)
      throw UserError(this->scene.bodies.front().where,
                      "nothing holds the material, and without inertia forces alone do not tell how it "
                      "moves as a whole; clamp a side or a layer, or solve with 'Method = sph'");
    islands->find();
    n_pairings = system.n_pairings;
    if (const auto &body = islands->loose_body(); !body.empty())
      throw UserError(
        where_of_body(this->scene, body),
        "nothing holds rigid body '" + body +
          "', which the balance of forces moves, and without inertia forces alone do not tell how; give it a 'Drag' " +
          "or, if it touches nothing at the start, a 'Largest approach', hold what it touches, or solve with 'Method = sph'");
    if (!system.is_supported() && this->time == 0.)
      check_balance();
    if (!archive)
      check_islands();
    if (!is_implicit())
      Log::line("NSPH: explicit stresses are stable up to steps of " +
                brief(explicit_limit(this->scene, system.constitutions, this->settings)) + " s");
    if (archive)
      restore_solver(*archive);
    tell_of_islands();
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
            throw UserError(this->scene.loads.front().where,
                            "at t = " + brief(part * this->end_time) + " s the loads sum up to " +
                              brief(system.thickness() * sums[c]) + " N along " + "xyz"[c] +
                              ", and nothing holds the scene, which repeats in all directions; take the mean "
                              "out of the loads, hold something, or solve with 'Method = sph'");
      }
  }

  /// That of the system; detached where a body that the balance of forces moves has come loose.
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
    return find_islands();
  }

  /// Those of the pairs, if these are new; detached where one holds a body that the balance of forces moves. Collective.
  template <int dim>
  StepStatus
  NsphMethod<dim>::find_islands()
  {
    if (this->system->n_pairings == n_pairings)
      return StepStatus::ok;
    islands->find();
    if (const auto &body = islands->loose_body(); !body.empty())
      {
        Log::line("  rigid body '" + body + "' touches nothing that is held any more");
        return StepStatus::detached;
      }
    n_pairings = this->system->n_pairings;
    return StepStatus::ok;
  }

  /// Once a run, and counts them, of the committed state.
  template <int dim>
  void
  NsphMethod<dim>::tell_of_islands()
  {
    const auto &all = islands->all();
    if (most_islands == 0 && !all.empty())
      Log::warning("islands of particles that touch nothing that is held: " + std::to_string(all.size()) + ", with " +
                   std::to_string(islands->n_particles()) + " in all, one of them from " + place(all.front().X) +
                   " m. Forces do not tell how an island moves as a whole: it stays where it is and does not turn" +
                   (this->scene.contacts.empty() ? "" :
                                                   ". What a body alone touches bears no force: how far it goes along "
                                                   "with a body that leaves it or slides by is told by round-off"));
    most_islands = std::max<std::uint64_t>(most_islands, all.size());
  }

  /// Whether the loads of the stage push or turn an island, which is told of. Collective.
  template <int dim>
  bool
  NsphMethod<dim>::islands_are_driven() const
  {
    if (islands->all().empty())
      return false;
    Velocities forces = this->system->loads->last_force();
    if (this->system->contacts)
      for (const auto &[where, repulsion] : this->system->contacts->forces()) // no friction: an island touches nothing
        forces[where.first] += repulsion.force;
    const auto *const driven = islands->driven_by(forces);
    if (driven)
      Log::line("  loads or repulsion push or turn an island of particles that nothing holds (" +
                std::to_string(driven->n_particles) + ", one of them from " + place(driven->X) + " m)");
    return driven != nullptr;
  }

  /// Throws UserError where loads push or turn islands at some times of the run.
  template <int dim>
  void
  NsphMethod<dim>::check_islands() const
  {
    auto &system = *this->system;
    for (const double part : {0., .25, .5, .75, 1.})
      if (const auto *const driven = islands->driven_by(
            system.loads->force(system.particles, this->time + part * (this->end_time - this->time))))
        {
          const int body = body_at(this->scene, driven->X);
          throw UserError(
            this->scene.bodies[std::max(body, 0)].where,
            "loads push or turn an island of " + counted(driven->n_particles, "particle") +
              (body < 0 ? "" : " of body '" + this->scene.bodies[body].name + "'") + ", one of them at " +
              place(driven->X) +
              " m, that touch nothing that is held, and without inertia nothing tells how they move; hold "
              "them too, keep the loads off them, take a larger 'Spacing', or solve with 'Method = sph'");
        }
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
      {
        system.undo_draw();
        return status;
      }
    system.set_step(t, t_next);
    Pair mean, end; // over the step, and at its end
    bool changed = false;
    status       = system.start_contacts(false, changed);
    if (status == StepStatus::ok && changed)
      status = find_islands();
    work.hardest_solve = 1;
    if (status == StepStatus::ok)
      status = solve_with_contacts(mean, end, t, t_next, work);
    if (status == StepStatus::ok)
      status = commit(mean, end, dt, work);
    if (status != StepStatus::ok)
      {
        system.restore_contacts();
        system.undo_draw();
      }
    else
      {
        this->time = t_next;
        tell_of_islands();
        this->collect_scalars(t_next);
      }
    return status;
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
    history.add(std::move(system.particles.v), end.particles, system.particles.n_free, dt, system.neighbours->n_orders,
                this->scene.comm);
    work.longest_next = next_step(end.particles);
    system.commit(mean.particles, dt);
    end.particles.resize(system.particles.size()); // without wall points
    system.particles.v = std::move(end.particles);
    system.shift(mean.particles, dt);
    return StepStatus::ok;
  }

  template <int dim>
  void
  NsphMethod<dim>::describe_stepping(Output::Summary &summary) const
  {
    summary.method = "nsph";
    if (most_islands > 0)
      summary.results["islands"] = most_islands;
    (is_implicit() ? summary.used : summary.left_out).push_back("stiffness in the velocity system");
    summary.results["explicit_step_limit_s"] = explicit_limit(this->scene, this->system->constitutions, this->settings);
  }

  template class NsphMethod<2>;
  template class NsphMethod<3>;
} // namespace Stroma::Sph
