#include <stroma/base/text.h>
#include <stroma/sph/sph_method.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    /// Part of the bound on stable steps that is used.
    constexpr double safety = .8;
  } // namespace

  template <int dim>
  SphMethod<dim>::SphMethod(Parameters &p, const Scene<dim> &scene, const double end_time, Timers &timers)
    : ParticleMethod<dim>(p, scene, Dynamics::inertial, end_time, timers)
  {
    for (unsigned int m = 0; m < scene.media.size(); ++m)
      if (!(scene.media[m].density > 0.))
        throw UserError("material '" + scene.material_names[m] + "'", "'Density' is missing, but 'Method = sph' moves by inertia");
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
      result                  = std::min(result, this->settings.courant * h / std::sqrt(law.p_wave_modulus() / law.rho));
      const bool central      = this->scene.media[m].viscous_operator == Materials::ViscousOperator::central;
      if (law.mu > 0.) // (34), for the larger viscosity that longitudinal waves have with the central operator
        result = std::min(result, .125 * h * h * law.rho / (central ? 3. * law.mu : law.mu));
    }
    return result;
  }

  template <int dim>
  double
  SphMethod<dim>::spectral_limit() const
  {
    auto                                             &system = *this->system;
    const unsigned int                                n      = system.particles.n_free;
    std::vector<dealii::SymmetricTensor<2, dim>> stiffness(n), friction(n);
    system.elasticity->combine(1., 0.);
    system.elasticity->add_diagonal(stiffness);
    if (system.friction)
      system.friction->add_diagonal(friction, n);
    if (system.is_smooth)
    {
      system.elasticity->combine(0., 1.);
      system.elasticity->add_diagonal(friction);
    }
    // Twice the diagonal bounds the eigenvalue of a sum over pairs.
    double limit = std::numeric_limits<double>::max();
    for (unsigned int i = 0; i < n; ++i)
    {
      const double m = system.mass(i), c = 2. * eigenvalues(friction[i])[0] / m, k = 2. * eigenvalues(stiffness[i])[0] / m;
      limit = std::min(limit, 4. / (c + std::sqrt(c * c + 4. * k))); // of u'' + c u' + k u = 0 by symplectic Euler
    }
    return safety * dealii::Utilities::MPI::min(limit, this->scene.comm);
  }

  template <int dim>
  void
  SphMethod<dim>::prepare()
  {
    limit = std::min(step_limit(), spectral_limit());
    Log::line("SPH: steps are divided into parts of at most " + brief(limit) + " s");
    if (this->time == 0.)
      set_initial_velocity();
  }

  template <int dim>
  void
  SphMethod<dim>::set_initial_velocity()
  {
    auto &particles = this->system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (const auto &body : this->scene.bodies)
        if (body.initial_velocity.given() && body.contains(particles.X[i]))
          particles.v[i] = body.initial_velocity.value(particles.X[i], 0.);
  }

  template <int dim>
  StepStatus
  SphMethod<dim>::advance(const double t, const double t_next, StepWork &work)
  {
    const auto n = static_cast<unsigned int>(std::ceil((t_next - t) / limit * (1. - 1e-12)));
    auto      &system = *this->system;
    // A step that fails half-way must leave the state untouched.
    auto       particles  = system.particles;
    const auto mover_hold = system.mover_hold;
    const auto status     = go_to(t, t_next, n);
    work.residual_evaluations += n;
    work.hardest_solve = 1;
    if (status != StepStatus::ok)
    {
      system.particles  = std::move(particles);
      system.mover_hold = mover_hold;
      system.update_geometry(true);
      return status;
    }
    this->time = t_next;
    const auto scope = this->timers.scope("series");
    this->collect_scalars(t_next);
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  SphMethod<dim>::go_to(const double t, const double t_next, const unsigned int n)
  {
    auto        &system = *this->system;
    const double dt     = (t_next - t) / n;
    parts_to_refresh    = 0;
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
      auto v = std::move(system.particles.v);
      accelerate(v, t + part * dt, dt);
      system.impose(v);
      system.set_gradient(v);
      system.commit(v, dt);
    }
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  SphMethod<dim>::refresh_geometry(const double dt)
  {
    double      fastest   = 0.;
    const auto &particles = this->system->particles;
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      fastest = std::max(fastest, std::isfinite(particles.v[i].norm()) ? particles.v[i].norm() : std::numeric_limits<double>::max());
    fastest         = dealii::Utilities::MPI::max(fastest, this->scene.comm);
    const double dp = this->settings.arrangement.spacing;
    if (fastest == std::numeric_limits<double>::max())
      return StepStatus::not_finite;
    if (fastest * dt > .2 * dp)
      return StepStatus::moved_too_far;
    parts_to_refresh = static_cast<unsigned int>(std::clamp(2.5e-4 * dp / (fastest * dt + 1e-300), 1., 100.));
    return this->system->update_geometry();
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
