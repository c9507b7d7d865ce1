#include <stroma/base/text.h>
#include <stroma/fem/solid/method.h>
#include <stroma/output/collective.h>
#include <stroma/rigid/contact_rounds.h>
#include <stroma/scene/reactions.h>
#include <stroma/scene/rheology.h>
#include <stroma/simulation/newton_work.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/distributed/grid_refinement.h>
#include <deal.II/numerics/error_estimator.h>

namespace Stroma::Fem
{
  namespace
  {
    constexpr double short_time = 1. / 4096.; ///< over the end time: for derivatives of prescribed motions
  }                                           // namespace

  template <int dim>
  SolidMethod<dim>::SolidMethod(Parameters &p, const Scene<dim> &scene, const Settings<dim> &settings,
                                const double end_time, Timers &timers)
    : scene(scene)
    , settings(settings)
    , timers(timers)
    , end_time(end_time)
  {
    {
      const auto section = p.section("Newton", "nonlinear solver");
      newton_settings.add(p);
    }
    {
      const auto section = p.section("Linear solver", "conjugate gradients");
      linear_settings.add(p);
    }
    typename Scene<dim>::Abilities can;
    can.viscosity = can.history = can.periodic = can.contact = can.contact_friction = true;
    can.boundary_loads                                                              = true;
    can.rigid_bodies = can.rigid_forces = can.rigid_rotations = can.rigid_torques = true;
    can.rigid_masses                                                              = settings.inertia;
    can.inertia                                                                   = settings.inertia;
    can.rate_laws = settings.kinematics == Kinematics::small;
    scene.require("fem", can);
    facts.depends_on_rates = settings.order != Solvers::Order::statics || n_history(scene) > 0;
    facts.point_fields     = {"displacement",  "velocity", "von_mises", "pressure",
                              "cauchy_stress", "J",        "material",  "volume"};
    facts.sampled_fields   = {"displacement", "displacement_gradient", "von_mises", "pressure", "cauchy_stress"};
    if (settings.kinematics == Kinematics::finite)
      facts.add_deformation_fields();
    else // the others are not the strains and stresses of the theory
      facts.point_fields.emplace_back("principal_stress");
    if (settings.order != Solvers::Order::statics)
      facts.sampled_fields.push_back("velocity");
    for (const auto &rigid : scene.rigid_bodies)
      if (settings.inertia && rigid.drive.turns())
        throw UserError(rigid.where, "rigid body '" + rigid.name +
                                       "' turns, which finite elements solve only without " +
                                       "inertia; set 'FEM/Inertia = false', or let it not turn");
    for (unsigned int m = 0; m < scene.materials.size(); ++m)
      if (settings.inertia && !(scene.media[m].density > 0.))
        throw UserError(scene.of_material(m),
                        "motion with inertia needs a 'Density'; give it or set 'FEM/Inertia = false'");
    if (settings.order != Solvers::Order::statics)
      refuse_history(scene);
  }

  template <int dim>
  void
  SolidMethod<dim>::build()
  {
    const auto scope = timers.scope("unknowns");
    system.reset();
    unknowns = std::make_unique<Unknowns<dim>>(scene, settings, *mesh, end_time);
    system   = std::make_unique<SolidSystem<dim>>(scene, settings, *mesh, *unknowns, timers);
    linear_solver->forget();
    K.clear();
    linear_solver->set_near_null_space(unknowns->rigid_motions());
    motion.u = system->new_vector();
    if (settings.order != Solvers::Order::statics)
      motion.v = system->new_vector();
    if (settings.order == Solvers::Order::second)
      motion.a = system->new_vector();
    last_increment.clear();
    last_dt = 0.;
  }

  template <int dim>
  void
  SolidMethod<dim>::setup(const Output::ArchiveReader *archive)
  {
    {
      const auto scope = timers.scope("mesh");
      mesh             = std::make_unique<Mesh<dim>>(scene, settings);
    }
    linear_solver = std::make_unique<Solvers::LinearSolver>(linear_settings);
    scheme        = std::make_unique<Solvers::TimeScheme>(settings.scheme, settings.order);
    if (archive)
      {
        if (archive->has("refined_cells"))
          mesh->repeat(Output::gather_all(archive->read_uint64("refined_cells"), scene.comm));
        build();
        load(*archive);
        return;
      }
    build();
    find_free_parts();
    for (unsigned int cycle = 0; cycle < settings.error_cycles; ++cycle)
      refine_by_error();
    if (start() != StepStatus::ok)
      throw UserError(settings.where_cells,
                      "the equations cannot be evaluated at the start (mass matrix or first residual)");
  }

  template <int dim>
  void
  SolidMethod<dim>::find_free_parts()
  {
    if (settings.inertia || !scene.contacts.empty())
      return; // then they may move freely
    const ConnectedParts<dim> parts(mesh->triangulation, std::vector<bool>(mesh->triangulation.n_active_cells(), true));
    const auto                free = system->free_parts(parts, end_time);
    n_free_parts                   = free.count();
    if (n_free_parts > 0)
      Log::warning(free.words());
  }

  /// Splits the cells with the largest jumps of the stress, of the linear solution for the loads and supports at the end.
  template <int dim>
  void
  SolidMethod<dim>::refine_by_error()
  {
    const auto     scope = timers.scope("error estimate");
    Solvers::Stage stage;
    stage.t = stage.dt = end_time;
    stage.v_known = stage.a_known = system->new_vector();
    Vector u(motion.u), r(motion.u), du(motion.u);
    system->set_stage(stage, end_time, motion.u);
    StepStatus status = system->residual(r, u);
    if (status == StepStatus::ok)
      status = system->tangent(K, r, u);
    if (status == StepStatus::ok && !linear_solver->solve(K, du, r, 1e-10).converged)
      status = StepStatus::linear_failed;
    if (status != StepStatus::ok)
      throw UserError(settings.where_cells, std::string("no error estimate: ") + to_string(status) +
                                              "; set 'FEM/Error cycles = 0' and refine by region");
    unknowns->distribute(du);
    dealii::Vector<float> error(mesh->triangulation.n_active_cells());
    dealii::KellyErrorEstimator<dim>::estimate(mesh->mapping(), unknowns->dofs,
                                               dealii::QGauss<dim - 1>(settings.degree + 1), {}, unknowns->on_mesh(du),
                                               error, {}, nullptr, dealii::numbers::invalid_unsigned_int,
                                               mesh->triangulation.locally_owned_subdomain());
    dealii::parallel::distributed::GridRefinement::refine_and_coarsen_fixed_number(mesh->triangulation, error,
                                                                                   settings.error_fraction, 0.);
    system.reset();
    unknowns.reset();
    mesh->refine();
    build();
  }

  template <int dim>
  void
  SolidMethod<dim>::set_initial_velocity()
  {
    for (const auto &[dof, component, X] : unknowns->owned_nodes())
      motion.v(dof) = scene.initial_velocity(X)[component];
    const auto &bodies = unknowns->inclusions;
    for (unsigned int r = 0; r < scene.rigid_bodies.size(); ++r)
      if (const auto &given = scene.bodies[scene.rigid_bodies[r].body].initial_velocity; given.given())
        for (unsigned int c = 0; c < dim; ++c)
          if (const auto dof = bodies.unknown(r, c); !bodies.is_prescribed(r, c) && motion.v.in_local_range(dof))
            motion.v(dof) = given.value(scene.rigid_bodies[r].pivot, 0.)[c];
    motion.v.compress(dealii::VectorOperation::insert);
    system->start_held(motion.v, short_time * end_time);
    unknowns->distribute_rate(motion.v);
  }

  /// The state at the start, so that a run that fails at once still leaves a complete picture.
  template <int dim>
  StepStatus
  SolidMethod<dim>::start()
  {
    Solvers::Stage stage;
    stage.v_known = stage.a_known = system->new_vector();
    if (settings.inertia)
      set_initial_velocity();
    system->set_stage(stage, 0., motion.u);
    StepStatus status = StepStatus::ok;
    if (settings.inertia)
      status = system->initial_acceleration(*linear_solver, K, motion.a, motion.u, motion.v, short_time * end_time);
    stage.v_known = motion.v;
    stage.a_known = motion.a;
    system->set_stage(stage, 0., motion.u);
    Vector r = system->new_vector();
    if (status == StepStatus::ok)
      status = system->residual(r, motion.u);
    collect_scalars(motion.u);
    return status;
  }

  template <int dim>
  StepStatus
  SolidMethod<dim>::solve_stage(const Solvers::Stage &stage, const double t, const double t_next, Vector &u,
                                StepWork &work)
  {
    system->set_stage(stage, t_next, motion.u);
    const Solvers::Newton newton(newton_settings, Solvers::print_iterations());
    const auto            scope = timers.scope("solve");
    return Rigid::solve_in_rounds(newton, *system, system->touching, *linear_solver, K, u, [&](const auto &result) {
      add(work, result);
      below_round_off.add(result, t);
    });
  }

  template <int dim>
  StepStatus
  SolidMethod<dim>::fail(const StepStatus status)
  {
    system->touching.restore();
    last_dt = 0.; // the next, shorter step starts from the committed state, not from an extrapolation
    return status;
  }

  template <int dim>
  StepStatus
  SolidMethod<dim>::advance(const double t, const double t_next, StepWork &work)
  {
    const double dt   = t_next - t;
    Vector       next = motion.u;
    linear_solver->forget(); // nothing but what is saved goes from step to step, so that a resumed run repeats this one
    if (last_dt > 0)
      next.add(dt / last_dt / scheme->n_stages(), last_increment);
    Rigid::start_step(*system, system->touching, motion.u);
    for (unsigned int i = 0; i < scheme->n_stages(); ++i)
      {
        const auto       stage  = scheme->stage(i, t, t_next, motion);
        const StepStatus status = solve_stage(stage, t, t_next, next, work);
        if (status != StepStatus::ok)
          return fail(status);
        scheme->finish_stage(i, stage, next);
      }
    auto end = scheme->end(t, t_next, motion);
    if (settings.order == Solvers::Order::second)
      if (const StepStatus status = system->evaluate_end({end.u, end.v, scheme->acceleration(motion, end)}, t_next);
          status != StepStatus::ok)
        return fail(status);
    if (end.v.size() > 0 && unknowns->inclusions.turn())
      unknowns->distribute_rate(end.v);
    last_increment = end.u;
    last_increment -= motion.u;
    last_dt = dt;
    motion  = std::move(end);
    system->commit();
    time = t_next;
    collect_scalars(next);
    return StepStatus::ok;
  }

  template <int dim>
  void
  SolidMethod<dim>::collect_scalars(const Vector &balanced)
  {
    scalars = reaction_scalars(scene, system->reactions(), time);
    for (const auto &scalar : system->reactions_at_rest())
      scalars.push_back(scalar);
    for (const auto &scalar : system->rigid_scalars(motion.u))
      scalars.push_back(scalar);
    scalars.emplace_back("strain_energy_J", system->strain_energy());
    if (settings.inertia)
      scalars.emplace_back("kinetic_energy_J", system->kinetic_energy(motion.v));
    for (const auto &scalar : system->contact_scalars(motion.u, balanced))
      scalars.push_back(scalar);
  }

  template class SolidMethod<2>;
  template class SolidMethod<3>;
} // namespace Stroma::Fem
