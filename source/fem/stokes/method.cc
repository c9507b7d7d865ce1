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
    if (depends_on_past())
      {
        const auto section = p.section("FEM");
        scheme.name        = Solvers::SchemeName::backward_euler;
        scheme.add(p, Solvers::Order::first);
      }
    check_scene();
    for (const auto &body : scene.rigid_bodies)
      rigid.emplace_back(body);
    facts.depends_on_rates    = true;
    facts.point_fields        = {"velocity", "von_mises", "pressure", "cauchy_stress", "material", "volume"};
    facts.sampled_fields      = {"velocity", "velocity_gradient", "pressure", "von_mises"};
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
    can.inertia      = settings.inertia;
    can.rigid_forces = can.rigid_torques = !settings.inertia;
    scene.require("fem", can);
    for (unsigned int m = 0; m < scene.media.size(); ++m)
      if (settings.inertia && !(scene.media[m].density > 0.))
        throw UserError(scene.of_material(m),
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
      system      = std::make_unique<StokesSystem<dim>>(*space, settings);
      free_bodies = std::make_unique<FreeBodies<dim>>(*space);
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
    of_bodies.assign(free_bodies->size(), 0.);
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

  /// Matrices, preconditioner and responses of free bodies for stages of this rate; none of them depends on which step is first.
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
    {
      const auto scope = timers.scope("preconditioner");
      free_level       = system->level_is_free(matrices);
      if (!solver->set_up(space->free_motions()))
        return StepStatus::not_finite;
    }
    const StepStatus status = find_responses(rate);
    if (status == StepStatus::ok)
      assembled_rate = rate;
    return status;
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
    StokesFlow r;
    system->residual(r, next, rates);
    const StepStatus solved = correct(next, r, work);
    if (solved == StepStatus::ok && free_bodies->size() > 0)
      move_free_bodies(next, t, rates);
    return solved;
  }

  template <int dim>
  StepStatus
  StokesMethod<dim>::correct(StokesFlow &flow, StokesFlow &r, StepWork &work)
  {
    StokesFlow correction;
    space->fixed_velocity.set_zero(r.v);
    if (free_level)
      system->make_compatible(r.p);

    const auto result = solver->solve(correction, r);
    ++work.newton_iterations;
    ++work.residual_evaluations;
    work.linear_iterations += result.iterations;
    if (!result.converged)
      return std::isfinite(correction.v.l2_norm()) ? StepStatus::linear_failed : StepStatus::not_finite;
    flow.v += correction.v;
    flow.p += correction.p;
    space->tied_velocity.distribute(flow.v);
    space->tied_pressure.distribute(flow.p);
    if (free_level)
      system->remove_mean(flow.p);
    return StepStatus::ok;
  }

  /// The flows of unit velocities of free bodies, and from the forces of these the bodies' mobility. What this takes is of no
  /// step's work, as little as the preconditioner: a run that is resumed does it once more.
  template <int dim>
  StepStatus
  StokesMethod<dim>::find_responses(const double rate)
  {
    const unsigned int n = free_bodies->size();
    if (n == 0)
      return StepStatus::ok;
    const auto scope = timers.scope("solve");
    StepWork   not_counted;
    StokesFlow unbalanced;
    responses.clear();
    dealii::FullMatrix<double> resistance(n, n);
    for (unsigned int k = 0; k < n; ++k)
      {
        StokesFlow flow{space->new_velocity(), space->new_pressure()};
        free_bodies->impose(flow.v, k);
        system->homogeneous_residual(unbalanced, flow, rate);
        const StepStatus status = correct(flow, unbalanced, not_counted);
        if (status != StepStatus::ok)
          return status;
        system->homogeneous_residual(unbalanced, flow, rate);
        const auto forces = free_bodies->forces(unbalanced.v);
        for (unsigned int l = 0; l < n; ++l)
          resistance(l, k) = -forces[l];
        responses.push_back(flow);
      }
    mobility = resistance;
    mobility.gauss_jordan();
    return StepStatus::ok;
  }

  template <int dim>
  void
  StokesMethod<dim>::move_free_bodies(StokesFlow &flow, const double t, const StokesRates &rates)
  {
    StokesFlow unbalanced;
    system->residual(unbalanced, flow, rates);
    auto       acting  = free_bodies->loads(t);
    const auto of_flow = free_bodies->forces(unbalanced.v);
    of_bodies.assign(acting.size(), 0.);
    for (unsigned int k = 0; k < acting.size(); ++k)
      for (unsigned int l = 0; l < acting.size(); ++l)
        of_bodies[k] += mobility(k, l) * (acting[l] + of_flow[l]);
    for (unsigned int k = 0; k < acting.size(); ++k)
      {
        flow.v.add(of_bodies[k], responses[k].v);
        flow.p.add(of_bodies[k], responses[k].p);
      }
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
    flow              = next;
    const auto twists = free_bodies->twists(of_bodies);
    for (unsigned int r = 0; r < rigid.size(); ++r)
      rigid[r].commit(rigid[r].next(t, t_next, twists[r]));
    time = t_next;
    collect_scalars(unbalanced.v);
    return StepStatus::ok;
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
