#include <stroma/fem/stokes/method.h>

#include <deal.II/base/mpi.h>

#include <cmath>

namespace Stroma::Fem
{
  namespace
  {
    /// @p rate with the round-off of the step's length taken away, so that equal steps share one matrix.
    double
    shared_rate(const double rate)
    {
      int          exponent;
      const double mantissa = std::frexp(rate, &exponent);
      return std::ldexp(std::round(std::ldexp(mantissa, 36)), exponent - 36);
    }
  } // namespace

  template <int dim>
  StokesMethod<dim>::StokesMethod(Parameters &p, const Scene<dim> &scene, const Settings<dim> &settings,
                                  const double end_time, Timers &timers)
    : scene(scene)
    , settings(settings)
    , end_time(end_time)
    , timers(timers)
  {
    check_scene();
    for (const auto &body : scene.rigid_bodies)
      rigid.emplace_back(body);
    facts.writes_points  = false;
    facts.sampled_fields = {"velocity", "velocity_gradient", "pressure", "von_mises"};
    if (depends_on_past())
      {
        const auto section = p.section("FEM");
        scheme.name        = Solvers::SchemeName::backward_euler;
        scheme.add(p, Solvers::Order::first);
      }
    const auto section        = p.section("Linear solver", "minimal residuals");
    linear_settings.tolerance = 1e-10;
    linear_settings.add(p);
  }

  template <int dim>
  void
  StokesMethod<dim>::check_scene() const
  {
    typename Scene<dim>::Abilities can;
    can.fluids = can.viscosity = can.rigid_bodies = can.periodic = can.boundary_loads = can.velocities = true;
    can.rigid_rotations                                                                                = true;
    can.inertia = settings.inertia;
    scene.require("fem", can);
    for (unsigned int m = 0; m < scene.media.size(); ++m)
      if (settings.inertia && !(scene.media[m].density > 0.))
        throw UserError("material '" + scene.material_names[m] + "'",
                        "'Density' is missing, but 'FEM/Inertia' is true; give the density or leave inertia out");
  }

  template <int dim>
  bool
  StokesMethod<dim>::depends_on_past() const
  {
    bool compressible = false;
    for (const auto &medium : scene.media)
      compressible |= std::isfinite(medium.bulk_modulus);
    return compressible || settings.inertia;
  }

  template <int dim>
  void
  StokesMethod<dim>::setup(const Output::ArchiveReader *archive)
  {
    {
      const auto scope = timers.scope("mesh");
      mesh             = std::make_unique<Mesh<dim>>(scene, settings);
    }
    {
      const auto scope = timers.scope("unknowns");
      space            = std::make_unique<StokesSpace<dim>>(*mesh, scene, settings, end_time);
      if (!settings.inertia)
        space->check_determined();
      system = std::make_unique<StokesSystem<dim>>(*space, settings);
    }
    solver = std::make_unique<StokesSolver>(linear_settings, matrices);
    start();
    if (archive)
      load(*archive);
  }

  template <int dim>
  void
  StokesMethod<dim>::start()
  {
    flow = {space->new_velocity(), space->new_pressure()};
    if (settings.inertia)
      {
        const auto X = space->places(space->velocity_dofs);
        const auto c = space->components();
        for (unsigned int i = 0; i < X.size(); ++i)
          flow.v.begin()[i] = scene.initial_velocity(X[i])[c[i]];
        space->impose(flow.v, 0.);
      }
    collect_scalars(space->new_velocity());
  }

  /// Matrices and preconditioner for stages of this rate.
  template <int dim>
  StepStatus
  StokesMethod<dim>::use_rate(const double rate)
  {
    if (rate == assembled_rate)
      return StepStatus::ok;
    assembled_rate = -1.;
    {
      const auto scope = timers.scope("assembly");
      system->assemble(matrices, rate);
    }
    const auto scope = timers.scope("preconditioner");
    free_level       = system->level_is_free(matrices);
    if (!solver->set_up(space->free_motions()))
      return StepStatus::not_finite;
    assembled_rate = rate;
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  StokesMethod<dim>::solve_stage(StokesFlow &next, const double t, const double inner_step, const StokesRates &rates,
                                 StepWork &work)
  {
    const StepStatus status = use_rate(shared_rate(rates.rate));
    if (status != StepStatus::ok)
      return status;
    const auto scope = timers.scope("solve");
    next             = {space->new_velocity(), space->new_pressure()};
    if (inner_step > 0.)
      space->impose_rate(next.v, t, rates.rate, rates.velocity_known, inner_step / 1024.);
    else
      space->impose(next.v, t);
    system->set_time(t);
    StokesFlow r, correction;
    system->residual(r, next, rates);
    space->fixed_velocity.set_zero(r.v);
    if (free_level)
      system->make_compatible(r.p);

    const auto result = solver->solve(correction, r);
    ++work.newton_iterations;
    ++work.residual_evaluations;
    work.linear_iterations += result.iterations;
    if (!result.converged)
      return std::isfinite(correction.v.l2_norm()) ? StepStatus::linear_failed : StepStatus::not_finite;
    next.v += correction.v;
    next.p += correction.p;
    space->tied_velocity.distribute(next.v);
    space->tied_pressure.distribute(next.p);
    if (free_level)
      system->remove_mean(next.p);
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  StokesMethod<dim>::advance(const double t, const double t_next, StepWork &work)
  {
    StokesFlow  next;
    StokesRates rates;
    if (!depends_on_past())
      {
        const StepStatus status = solve_stage(next, t_next, 0., rates, work);
        if (status != StepStatus::ok)
          return status;
      }
    else
      {
        Solvers::TimeScheme of_velocity(scheme, Solvers::Order::first), of_pressure(scheme, Solvers::Order::first);
        for (unsigned int i = 0; i < of_pressure.n_stages(); ++i)
          {
            const Solvers::Stage pressure = of_pressure.stage(i, t, t_next, {flow.p, {}, {}});
            const Solvers::Stage velocity = of_velocity.stage(i, t, t_next, {flow.v, {}, {}});
            rates.rate                    = pressure.v_factor;
            rates.pressure_known          = pressure.v_known;
            if (settings.inertia)
              rates.velocity_known = velocity.v_known;
            const StepStatus status = solve_stage(next, pressure.t,
                                                  settings.inertia && !velocity.is_last ? t_next - t : 0., rates, work);
            if (status != StepStatus::ok)
              return status;
            of_pressure.finish_stage(i, pressure, next.p);
            of_velocity.finish_stage(i, velocity, next.v);
          }
      }
    StokesFlow unbalanced;
    system->residual(unbalanced, next, rates);
    flow = next;
    for (auto &body : rigid)
      body.commit(body.next(t, t_next));
    time = t_next;
    collect_scalars(unbalanced.v);
    return StepStatus::ok;
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
