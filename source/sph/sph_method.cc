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

    /// In a part of a step, over the spacing.
    constexpr double largest_move = .2;
  } // namespace

  template <int dim>
  SphMethod<dim>::SphMethod(Parameters &p, const Scene<dim> &scene, const double end_time, Timers &timers)
    : ParticleMethod<dim>(p, scene, Dynamics::inertial, end_time, timers)
  {
    for (unsigned int m = 0; m < scene.media.size(); ++m)
      if (!(scene.media[m].density > 0.))
        throw UserError("material '" + scene.material_names[m] + "'",
                        "'Density' is missing, but 'Method = sph' moves by inertia");
  }

  template <int dim>
  double
  SphMethod<dim>::step_limit() const
  {
    const double h      = this->settings.h();
    double       result = std::numeric_limits<double>::max();
    for (unsigned int m = 0; m < this->system->constitutions.size(); ++m)
      {
        const Constitution &law = this->system->constitutions[m];
        result             = std::min(result, this->settings.courant * h / std::sqrt(law.p_wave_modulus() / law.rho));
        const bool central = this->scene.media[m].viscous_operator == Materials::ViscousOperator::central;
        if (law.mu > 0.) // (34), for the larger viscosity that longitudinal waves have with the central operator
          result = std::min(result, .125 * h * h * law.rho / (central ? 3. * law.mu : law.mu));
      }
    return result;
  }

  template <int dim>
  double
  SphMethod<dim>::spectral_limit() const
  {
    const auto  &system = *this->system;
    const double c      = largest_rate([&](Velocities &f, const Velocities &v) { system.add_friction(f, v); });
    system.elasticity->combine(1., 0.);
    const double k = largest_rate(
      [&](Velocities &f, const Velocities &v) { system.elasticity->add_stiffness_force(f, v); });
    return safety * 4. / (c + std::sqrt(c * c + 4. * k)); // u'' + c u' + k u = 0 by symplectic Euler
  }

  template <int dim>
  template <typename AddForce>
  double
  SphMethod<dim>::largest_rate(const AddForce &add_force) const
  {
    const auto &system    = *this->system;
    const auto &particles = system.particles;
    Velocities  v(system.pairs.n_points()), f;
    double      rate = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (unsigned int d = 0; d < dim; ++d)
        v[i][d] = std::sin(1e4 * (particles.id[i] + .37 * d)); // rough, and the same on any number of ranks
    for (unsigned int iteration = 0; iteration < power_iterations; ++iteration)
      {
        system.neighbours->update_ghosts(v);
        f.assign(particles.n_free, {});
        add_force(f, v);
        double before = 0., after = 0.;
        for (unsigned int i = 0; i < particles.n_free; ++i)
          {
            f[i] /= -system.mass(i);
            before += v[i].norm_square();
            after += f[i].norm_square();
          }
        rate = std::sqrt(dealii::Utilities::MPI::sum(after, this->scene.comm) /
                         dealii::Utilities::MPI::sum(before, this->scene.comm));
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
    limit = std::min(step_limit(), spectral_limit());
    if (!(limit > smallest_part * step_limit())) // nor if it is not a number
      return StepStatus::moved_too_far;
    system.set_gradient(system.with_walls(system.particles.v)); // that of an earlier attempt says nothing of this one
    const auto n = static_cast<unsigned int>(std::ceil((t_next - t) / limit * (1. - 1e-9)));
    // A step that fails half-way must leave the state untouched.
    auto       particles             = system.particles;
    const auto mover_hourglass_force = system.mover_hourglass_force;
    const auto poses                 = system.poses;
    const auto status                = go_to(t, t_next, n);
    work.residual_evaluations += n;
    work.hardest_solve = 1;
    if (status != StepStatus::ok)
      {
        system.particles             = std::move(particles);
        system.mover_hourglass_force = mover_hourglass_force;
        system.poses                 = poses;
        system.now                   = t;
        system.update_geometry(true);
        return status;
      }
    this->time       = t_next;
    const auto scope = this->timers.scope("series");
    this->collect_scalars(t_next);
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
    double fastest = 0.;
    for (unsigned int i = 0; i < system.particles.n_owned; ++i)
      fastest = std::max(fastest, system.particles.v[i].norm());
    fastest          = dealii::Utilities::MPI::max(fastest, this->scene.comm);
    parts_to_refresh = static_cast<unsigned int>(
      std::clamp(2.5e-4 * this->settings.arrangement.spacing / (fastest * dt + 1e-300), 1., 100.));
    return system.update_geometry();
  }

  template <int dim>
  void
  SphMethod<dim>::accelerate(Velocities &v, const double t, const double dt)
  {
    auto &system = *this->system;
    system.state_forces(force, t);
    system.add_friction(force, v);
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      v[i] += dt / system.mass(i) * force[i];
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
