#include <stroma/base/text.h>
#include <stroma/particles/lattice.h>
#include <stroma/sph/sph_method.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    /// Part of the bound on stable steps that is used.
    constexpr double safety = .7;

    /// Of the power method, for the largest rates of friction and stiffness.
    constexpr unsigned int power_iterations = 20;

    /// Smallest stable part of a step, over that of the material as it is laid out: below it the particles are lost.
    constexpr double smallest_part = 1e-3;
    /// Parts of steps of a run; so many take weeks even of a few hundred particles.
    constexpr double most_parts = 1e9;

    /// In a part of a step, over the spacing.
    constexpr double largest_move = .2;

    /// Of the pairs of row @p i with walls, see BodyBalance.
    template <int dim, typename Add>
    void
    visit_wall_friction(const System<dim> &system, const unsigned int i, const typename System<dim>::Velocities &v,
                        const Add &add)
    {
      for (unsigned int p = system.pairs.row_fixed[i]; p < system.pairs.row_start[i + 1]; ++p)
        add(p, system.friction_of_pair(i, p, v));
    }
  } // namespace

  template <int dim>
  SphMethod<dim>::SphMethod(Parameters &p, const Scene<dim> &scene, const double end_time, Timers &timers)
    : ParticleMethod<dim>(p, scene, Dynamics::inertial, end_time, timers)
  {
    for (unsigned int m = 0; m < scene.media.size(); ++m)
      if (!(scene.media[m].density > 0.))
        throw UserError(scene.of_material(m), "'Density' is missing, but 'Method = sph' moves by inertia");
    for (const auto &rigid : scene.rigid_bodies)
      if (rigid.drive.is_by_balance() && !(rigid.resistance.mass > 0.))
        throw UserError(rigid.where, "forces move rigid body '" + rigid.name +
                                       "', which needs a 'Density' or 'Mass': 'Method = sph' moves by inertia");
    for (unsigned int m = 0; m < scene.media.size(); ++m)
      if (const double parts = end_time / step_limit(m); parts > most_parts)
        throw UserError(
          scene.of_material(m),
          "the run would take " + brief(parts) +
            " parts of steps, which for its speed of sound and viscosity must not be longer than " +
            brief(step_limit(m)) +
            " s; raise 'Density', lower 'Viscosity' or 'End', or set 'Method = nsph', which takes any step");
  }

  template <int dim>
  double
  SphMethod<dim>::step_limit(const unsigned int m) const
  {
    const double        h       = this->settings.h();
    const Constitution &law     = this->system->constitutions[m];
    const double        courant = this->settings.courant * h / std::sqrt(law.p_wave_modulus() / law.rho);
    const bool          central = this->scene.media[m].viscous_operator == Materials::ViscousOperator::central;
    if (!(law.mu > 0.))
      return courant;
    // (34), for the larger viscosity that longitudinal waves have with the central operator
    return std::min(courant, .125 * h * h * law.rho / (central ? 3. * law.mu : law.mu));
  }

  template <int dim>
  double
  SphMethod<dim>::step_limit() const
  {
    double result = std::numeric_limits<double>::max();
    for (unsigned int m = 0; m < this->scene.media.size(); ++m)
      result = std::min(result, step_limit(m));
    return result;
  }

  template <int dim>
  double
  SphMethod<dim>::spectral_limit() const
  {
    const auto  &system = *this->system;
    const auto   drag   = system.bodies ? system.bodies->resistance() : dealii::FullMatrix<double>();
    const double c      = largest_rate([&](Velocities &f, const Velocities &v) { system.add_friction(f, v); },
                                  [&](const unsigned int i, const Velocities &v, const auto &add) {
                                    visit_wall_friction(system, i, v, add);
                                  },
                                  drag);
    system.elasticity->combine(1., 0.);
    const double k = largest_rate([&](Velocities       &f,
                                      const Velocities &v) { system.elasticity->add_stiffness_force(f, v); },
                                  [&](const unsigned int i, const Velocities &v, const auto &add) {
                                    system.elasticity->visit_wall_responses(i, v, add);
                                  },
                                  dealii::FullMatrix<double>());
    return safety * 4. / (c + std::sqrt(c * c + 4. * k)); // u'' + c u' + k u = 0 by symplectic Euler
  }

  template <int dim>
  template <typename AddForce, typename OnWalls>
  double
  SphMethod<dim>::largest_rate(const AddForce &add_force, const OnWalls &on_walls,
                               const dealii::FullMatrix<double> &of_bodies) const
  {
    const auto                &system    = *this->system;
    const auto                &particles = system.particles;
    const auto                &bodies    = system.bodies;
    Velocities                 v(system.pairs.n_points()), f;
    double                     rate = 0.;
    std::vector<double>        q(bodies ? bodies->size() : 0, 1.), q_rate;
    dealii::FullMatrix<double> inverse_mass;
    if (bodies)
      {
        inverse_mass = bodies->spread(bodies->masses());
        inverse_mass.gauss_jordan();
      }
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (unsigned int d = 0; d < dim; ++d)
        v[i][d] = std::sin(1e4 * (particles.id[i] + .37 * d)); // rough, and the same on any number of ranks
    for (unsigned int iteration = 0; iteration < power_iterations; ++iteration)
      {
        system.neighbours->update_ghosts(v);
        if (bodies)
          bodies->set_velocities(v, q);
        f.assign(particles.n_free, {});
        add_force(f, v);
        if (bodies)
          q_rate = bodies->rates(bodies->forces([&](const unsigned int i, const auto &add) { on_walls(i, v, add); }), q,
                                 of_bodies, inverse_mass);
        double before = 0., after = 0.;
        for (unsigned int i = 0; i < particles.n_free; ++i)
          {
            f[i] /= -system.mass(i);
            before += v[i].norm_square();
            after += f[i].norm_square();
          }
        before = dealii::Utilities::MPI::sum(before, this->scene.comm);
        after  = dealii::Utilities::MPI::sum(after, this->scene.comm);
        for (unsigned int u = 0; u < q.size(); ++u)
          {
            before += q[u] * q[u];
            after += q_rate[u] * q_rate[u];
          }
        rate = std::sqrt(after / before);
        for (unsigned int u = 0; u < q.size(); ++u)
          q[u] = rate > 0. ? -q_rate[u] / rate : -q_rate[u];
        for (unsigned int i = 0; i < particles.n_free; ++i)
          v[i] = rate > 0. ? f[i] / rate : f[i];
      }
    return rate;
  }

  template <int dim>
  void
  SphMethod<dim>::prepare(const Output::ArchiveReader *archive)
  {
    limit = std::min(step_limit(), spectral_limit());
    Log::line("SPH: steps are divided into parts of at most " + brief(limit) + " s");
    if (!archive && this->time == 0.)
      set_initial_velocity();
  }

  template <int dim>
  void
  SphMethod<dim>::setup(const Output::ArchiveReader *archive)
  {
    if (this->settings.energy_flow && this->system->has_solids())
      energy_flow = std::make_unique<EnergyFlow<dim>>(*this->system);
    ParticleMethod<dim>::setup(archive);
    if (energy_flow && archive)
      energy_flow->total = {archive->attribute_double("work"), archive->attribute_double("heat")};
    else
      collect_energies();
  }

  template <int dim>
  void
  SphMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    ParticleMethod<dim>::save(archive);
    if (!energy_flow)
      return;
    archive.attribute("work", energy_flow->total.work);
    archive.attribute("heat", energy_flow->total.heat);
  }

  template <int dim>
  void
  SphMethod<dim>::collect_energies()
  {
    if (!energy_flow)
      return;
    this->scalars.emplace_back("work_J", energy_flow->total.work);
    this->scalars.emplace_back("dissipated_energy_J", energy_flow->total.heat);
  }

  template <int dim>
  void
  SphMethod<dim>::set_initial_velocity()
  {
    auto &particles = this->system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      particles.v[i] = this->scene.initial_velocity(particles.X[i]);
  }

  template <int dim>
  StepStatus
  SphMethod<dim>::advance(const double t, const double t_next, StepWork &work)
  {
    auto      &system = *this->system;
    const auto moved  = system.update_geometry();
    if (moved != StepStatus::ok)
      return moved;
    if (system.bodies)
      system.bodies->set_resistance(t, t_next - t);
    limit = std::min(step_limit(), spectral_limit());
    if (!(limit > smallest_part * step_limit())) // nor if it is not a number
      return StepStatus::moved_too_far;
    system.set_gradient(system.with_walls(system.particles.v)); // that of an earlier attempt says nothing of this one
    const auto n = static_cast<unsigned int>(std::ceil((t_next - t) / limit * (1. - 1e-9)));
    // A step that fails half-way must leave the state untouched.
    auto       particles = system.particles;
    const auto poses     = system.poses;
    const auto twists    = system.twists;
    const auto momenta   = system.momenta;
    const auto drawn_at  = system.drawn_at;
    if (energy_flow)
      energy_flow->start_step();
    const auto status = go_to(t, t_next, n);
    work.residual_evaluations += n;
    work.hardest_solve = 1;
    if (status != StepStatus::ok)
      {
        system.particles = std::move(particles);
        system.poses     = poses;
        system.twists    = twists;
        system.momenta   = momenta;
        system.now       = t;
        system.drawn_at  = drawn_at;
        system.update_geometry(true);
        return status;
      }
    this->time       = t_next;
    const auto scope = this->timers.scope("series");
    this->collect_scalars(t_next);
    if (energy_flow)
      energy_flow->end_step();
    collect_energies();
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  SphMethod<dim>::go_to(const double t, const double t_next, const unsigned int n)
  {
    auto        &system    = *this->system;
    const double dt        = (t_next - t) / n;
    double       unshifted = 0.; // time since the last shift [s]
    parts_to_refresh       = 0;
    for (unsigned int part = 0; part < n; ++part)
      {
        if (parts_to_refresh == 0)
          {
            const auto status = refresh_geometry(dt);
            if (status != StepStatus::ok)
              return status;
          }
        --parts_to_refresh;
        const auto scope = this->timers.scope("forces and motion");
        system.set_step(t + part * dt, t + (part + 1) * dt);
        auto v = system.with_walls(std::move(system.particles.v));
        accelerate(v, t + part * dt, dt);
        system.impose(v);
        if (energy_flow)
          energy_flow->take_part(force, v, dt);
        system.set_gradient(v);
        system.commit(v, dt);
        unshifted += dt;
        if (parts_to_refresh > 0 && part + 1 < n)
          continue;
        system.shift(v, unshifted);
        unshifted = 0.;
      }
    return system.check(system.particles.v, dt, largest_move, 1.); // the end must be good as well
  }

  template <int dim>
  StepStatus
  SphMethod<dim>::refresh_geometry(const double dt)
  {
    auto      &system = *this->system;
    const auto status = system.check(system.particles.v, dt, largest_move, 1.);
    if (status != StepStatus::ok)
      return status;
    double fastest = system.fastest_body();
    for (unsigned int i = 0; i < system.particles.n_owned; ++i)
      fastest = std::max(fastest, system.particles.v[i].norm());
    fastest          = dealii::Utilities::MPI::max(fastest, this->scene.comm);
    parts_to_refresh = static_cast<unsigned int>(
      std::clamp(2.5e-4 * this->settings.arrangement.spacing / (fastest * dt + 1e-300), 1., 100.));
    const auto moved = system.update_geometry();
    bool       changed;
    return moved == StepStatus::ok ? system.start_contacts(true, changed) : moved;
  }

  template <int dim>
  void
  SphMethod<dim>::accelerate(Velocities &v, const double t, const double dt)
  {
    auto &system = *this->system;
    if (system.bodies || energy_flow)
      find_forces_apart(v, t, dt);
    else
      system.forces(force, v, t);
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      v[i] += dt / system.mass(i) * force[i];
  }

  /// Forces where those of the state are asked for by themselves; accelerates bodies.
  template <int dim>
  void
  SphMethod<dim>::find_forces_apart(const Velocities &v, const double t, const double dt)
  {
    auto &system = *this->system;
    system.state_forces(force, t);
    if (system.bodies)
      on_bodies = system.state_forces_on_bodies(t);
    if (energy_flow)
      energy_flow->take_state(force, v);
    system.add_friction(force, v);
    if (system.bodies)
      accelerate_bodies(v, t, dt);
  }

  /// After the forces of the state on them are known, and those of friction between particles.
  template <int dim>
  void
  SphMethod<dim>::accelerate_bodies(const Velocities &v, const double t, const double dt)
  {
    auto      &system   = *this->system;
    const auto friction = system.bodies->forces(
      [&](const unsigned int i, const auto &add) { visit_wall_friction(system, i, v, add); });
    std::vector<Rigid::Twist<dim>> given(system.movers.size());
    system.add_given(given);
    auto twists = system.twists;
    system.add_given(twists);
    auto       resisting = system.bodies->drag_force(twists);
    const auto q_before  = system.bodies->unknowns_of(twists);
    for (unsigned int u = 0; u < on_bodies.size(); ++u)
      {
        resisting[u] += friction[u];
        on_bodies[u] += resisting[u];
      }
    const auto wrenches = system.bodies->wrenches_of(on_bodies);
    for (unsigned int m = 0; m < twists.size(); ++m)
      if (system.momenta[m])
        twists[m] = system.momenta[m]->advance(wrenches[m], given[m], system.poses[m], dt);
    const auto q = system.bodies->unknowns_of(twists);
    if (energy_flow)
      energy_flow->take_bodies(system.bodies->loads(t), resisting, q_before, q, dt);
    system.take_body_velocities(q, q);
  }

  template <int dim>
  void
  SphMethod<dim>::describe_stepping(Output::Summary &summary) const
  {
    summary.method                         = "sph";
    summary.results["stable_step_limit_s"] = limit;
  }

  template class SphMethod<2>;
  template class SphMethod<3>;
} // namespace Stroma::Sph
