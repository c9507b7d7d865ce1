#include <stroma/base/log.h>
#include <stroma/base/text.h>
#include <stroma/mpm/balance.h>
#include <stroma/mpm/method.h>
#include <stroma/mpm/point_weights.h>
#include <stroma/mpm/size.h>
#include <stroma/rigid/contact_rounds.h>
#include <stroma/scene/reactions.h>
#include <stroma/scene/rheology.h>
#include <stroma/simulation/newton_work.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace Stroma::Mpm
{
  namespace
  {
    /// Filling of a cell within the bodies below which a reset grid is said to hold too few points.
    constexpr double sparse = .75, sparse_for_splines = .9;

    /// Unknowns from which on a tangent that is kept as matrices of cells is faster, in the plane too.
    constexpr unsigned int large_grid = 5000;

    /// Of gradients and places of points: forces of a uniform stretch are right within .3 % up to here, and wrong by tens of per cent soon
    /// after; smooth motions have some thousandths.
    constexpr double largest_misfit = .05;
  } // namespace

  template <int dim>
  MpmMethod<dim>::MpmMethod(Parameters &p, const Scene<dim> &scene, const double end_time, Timers &timers)
    : scene(scene)
    , timers(timers)
    , end_time(end_time)
  {
    typename Scene<dim>::Abilities can;
    can.viscosity = can.history = can.contact = can.contact_friction = true;
    can.rigid_bodies = can.rigid_forces = can.rigid_rotations = can.rigid_torques = true;
    scene.require("mpm", can);
    {
      const auto section = p.section("MPM", "the material point method");
      settings.add(p, scene);
      if (p.get_mode() == Parameters::Mode::read)
        settings.check(scene);
    }
    {
      const auto section = p.section("Newton", "nonlinear solver");
      newton_settings.add(p);
    }
    {
      const auto section             = p.section("Linear solver", "conjugate gradients");
      linear_settings.preconditioner = Solvers::Preconditioner::automatic;
      linear_settings.add(p, Solvers::MorePreconditioners::geometric);
      where_preconditioner = p.where("Preconditioner");
    }
    if (settings.order != Solvers::Order::statics)
      refuse_history(scene);
    facts.depends_on_rates = settings.order != Solvers::Order::statics || n_history(scene) > 0;
    facts.point_fields     = {"displacement", "von_mises", "pressure", "cauchy_stress", "J", "material", "volume"};
    facts.sampled_fields   = {"displacement", "von_mises", "pressure", "cauchy_stress", "displacement_gradient"};
    facts.add_deformation_fields();
    unsigned int n_bodies = 0, n_images = 0; // of material
    for (const auto &body : scene.bodies)
      {
        n_bodies += !body.rigid;
        n_images += body.is_image();
      }
    if (n_bodies == 1 && n_images == 1 && !settings.gauss_points) // each voxel has its points
      std::copy_if(facts.point_fields.begin(), facts.point_fields.end(), std::back_inserter(facts.image_fields),
                   [](const std::string &field) { return field != "volume"; });
    for (const auto &change : settings.schedule)
      facts.times_to_meet.push_back(change.first);
  }

  template <int dim>
  void
  MpmMethod<dim>::setup(const Output::ArchiveReader *archive)
  {
    motion            = std::make_unique<PrescribedMotion<dim>>(scene, settings, end_time);
    const auto box    = settings.grid_box(scene);
    const bool driven = motion->any_drives_points();
    if (archive)
      settings.two_moments = archive->attribute_uint64("two_moments") != 0;
    else
      settings.choose_integration(scene, driven);
    settings.shares_stiffness = check_size(scene, settings, box, driven, assembled_up_to(driven)) ||
                                (archive && archive->attribute_uint64("shares_stiffness") != 0);
    warn_of_few_points(box, driven);
    log_choices();
    const bool from_file = archive && archive->has("points");
    {
      const auto scope = timers.scope("grid");
      grid             = std::make_unique<BackgroundGrid<dim>>(box, settings.shape_functions(), scene.comm);
      balance_by_material(*grid, scene);
    }
    {
      const auto scope = timers.scope("points");
      if (from_file)
        {
          points = std::make_unique<Points<dim>>(typename Points<dim>::WithoutPoints(), scene, settings, *grid, driven);
          load_points(*archive);
        }
      else
        {
          points = std::make_unique<Points<dim>>(scene, settings, *grid, driven);
          motion->mark_points(*points, box);
          if (points->load.stored())
            LoadedPoints<dim>(scene, *points).mark(*points);
        }
    }
    system        = std::make_unique<System<dim>>(scene, settings, *grid, *points, *motion, timers);
    linear_solver = std::make_unique<Solvers::LinearSolver>(linear_settings);
    scheme        = std::make_unique<Solvers::TimeScheme>(settings.scheme, settings.order);
    system->rebuild();
    if (!archive) // later they are what became of them
      {
        motion->check_nodes(*grid);
        find_free_parts();
        n_parts = settings.may_reset() ? connected_parts().n_groups() : 0;
      }
    allocate();
    if (archive)
      load_displacement(*archive);
    else
      {
        // The state at the start, so that a run that fails at once still leaves a complete picture.
        if (settings.order != Solvers::Order::statics)
          v = system->new_vector();
        Vector r = system->new_vector();
        system->set_committed(0., 0., v);
        system->residual(r, u);
        collect_scalars(0.);
      }
    prepare_solver();
  }

  template <int dim>
  void
  MpmMethod<dim>::log_choices() const
  {
    for (const auto &[choice, entry] :
         {std::pair(settings.about_interfaces, "Interface"), std::pair(settings.about_integration, "Integration")})
      if (!choice.empty())
        Log::line("  " + choice + " (MPM/" + entry + " = automatic)");
  }

  /// One point a cell lets it take shapes that cost no energy.
  template <int dim>
  void
  MpmMethod<dim>::warn_of_few_points(const GridBox<dim> &box, const bool drives_points) const
  {
    constexpr double about_one = 1.01;
    if (settings.shape == 0 && !settings.gauss_points && !settings.finds_points_in_images(scene, drives_points) &&
        settings.points_of_images_in_cell(scene, box) < about_one)
      Log::warning(
        "cells have one point of an image along some axis, which does not resist all of a cell's shapes: set "
        "'MPM/Points per voxel' to 2 there or, with 'Grid reset = never' and where no load or motion acts on single points, "
        "'MPM/Integration = two moments'");
  }

  /// The number of unknowns, as far as the scene tells before there is a system.
  template <int dim>
  double
  MpmMethod<dim>::assembled_up_to(const bool drives_points) const
  {
    const bool may_be_kept = !settings.may_reset() && settings.shape == 0 && !drives_points && !is_viscous(scene) &&
                             scene.rigid_bodies.empty();
    if (may_be_kept && linear_settings.preconditioner == Solvers::Preconditioner::geometric)
      return 0.;
    return may_be_kept && linear_settings.preconditioner == Solvers::Preconditioner::automatic ?
             large_grid :
             std::numeric_limits<double>::max();
  }

  /// Keeps the tangent as matrices of cells where that is asked for or worth while; else tells the linear solver of rigid motions.
  template <int dim>
  void
  MpmMethod<dim>::prepare_solver()
  {
    using Solvers::Preconditioner;
    const auto           scope       = timers.scope("unknowns");
    const Preconditioner asked       = linear_settings.preconditioner;
    const bool           may_be_kept = !settings.may_reset() && n_free_parts == 0 && system->acts_in_cells_only();
    if (asked == Preconditioner::geometric && !may_be_kept)
      throw UserError(where_preconditioner,
                      "'geometric' goes with 'Grid reset = never', linear shape functions and supports on sides or "
                      "'nearest' that hold every part, without viscosity, rigid bodies and contact; use 'amg' here");
    if (may_be_kept && (asked == Preconditioner::geometric ||
                        (asked == Preconditioner::automatic && !is_assembled && system->n_unknowns() > large_grid)))
      {
        system->keep_tangent();
        if (settings.shares_stiffness)
          Log::line(
            "  matrices of their own of all cells do not fit into memory: those that a material fills alike share "
            "one, and Newton's method needs more iterations");
        return;
      }
    if (const bool driven = motion->any_drives_points(); system->n_unknowns() > assembled_up_to(driven))
      check_size(scene, settings, grid->box(), driven, std::numeric_limits<double>::max()); // more than was counted on
    linear_solver->set_near_null_space(system->rigid_motions());
  }

  /// Assembles the tangent from now on where geometric multigrid has failed, as it may for a body that buckles. False if the
  /// choice is not left to the program, or where memory lacks. Collective.
  template <int dim>
  bool
  MpmMethod<dim>::assemble_instead()
  {
    if (linear_settings.preconditioner != Solvers::Preconditioner::automatic || !system->kept_tangent())
      return false;
    linear_solver->forget();
    is_assembled = true;
    try
      {
        prepare_solver();
      }
    catch (const UserError &) // on all ranks
      {
        is_assembled = false;
        return false;
      }
    system->assemble_tangent();
    Log::line("  geometric multigrid has failed: from here on the tangent is assembled, with algebraic multigrid");
    return true;
  }

  template <int dim>
  ConnectedParts<dim>
  MpmMethod<dim>::connected_parts() const
  {
    return {grid->triangulation, points->occupied_cells()};
  }

  template <int dim>
  void
  MpmMethod<dim>::find_free_parts()
  {
    if (!scene.contacts.empty())
      return; // then they may move freely
    const auto                scope = timers.scope("unknowns");
    const ConnectedParts<dim> parts = connected_parts();
    const auto                free  = system->free_parts(parts, end_time);
    n_free_parts                    = free.count();
    if (n_free_parts > 0)
      Log::warning(free.words());
  }

  template <int dim>
  void
  MpmMethod<dim>::allocate()
  {
    const auto scope = timers.scope("unknowns");
    linear_solver->forget(); // its hierarchy refers to the matrix
    K.clear();
    u = system->new_vector();
    v.clear();
    last_increment.clear();
    last_dt = 0.;
  }

  template <int dim>
  StepStatus
  MpmMethod<dim>::solve(const Solvers::Stage &stage, const double t, Vector &next, StepWork &work)
  {
    {
      const auto scope = timers.scope("targets and loads");
      system->set_stage(stage, rebase_time);
    }
    const Solvers::Newton newton(newton_settings, Solvers::print_iterations());
    const auto            scope = timers.scope("solve");
    return Rigid::solve_in_rounds(newton, *system, system->touching, *linear_solver, K, next, [&](const auto &result) {
      add(work, result);
      below_round_off.add(result, t);
    });
  }

  /// @param next in: the first guess; out: motion at the end of the step
  template <int dim>
  StepStatus
  MpmMethod<dim>::solve_stages(const double t, const double t_next, Solvers::Motion &next, StepWork &work)
  {
    Solvers::Motion start;
    if (scheme->looks_back())
      start.u = u;
    for (unsigned int i = 0; i < scheme->n_stages(); ++i)
      {
        const auto       stage  = scheme->stage(i, t, t_next, start);
        const StepStatus status = solve(stage, t, next.u, work);
        if (status != StepStatus::ok)
          return status;
        scheme->finish_stage(i, stage, next.u);
      }
    next = scheme->end(t, t_next, start);
    if (settings.two_moments) // the solve saw no more than the points that stand for the others
      return reduce(system->check_all_points(next.u), scene.comm);
    if (settings.may_reset() && !system->stays_on_grid(next.u))
      return StepStatus::left_grid;
    misfit = settings.weighs_points() && n_resets > 0 ? system->misfit(next.u) : 0.;
    return misfit > largest_misfit ? StepStatus::misfit : StepStatus::ok;
  }

  /// On the line through the last step, for the first stage of one over @p dt.
  template <int dim>
  Vector
  MpmMethod<dim>::first_guess(const double dt) const
  {
    Vector guess(u);
    if (last_dt > 0)
      guess.add(dt / last_dt / scheme->n_stages(), last_increment);
    return guess;
  }

  template <int dim>
  StepStatus
  MpmMethod<dim>::advance(const double t, const double t_next, StepWork &work)
  {
    if (!motion->holds_nodes())
      return StepStatus::support_lost;
    if (!is_whole)
      return StepStatus::torn;
    Solvers::Motion next{first_guess(t_next - t), {}, {}};
    linear_solver->forget(); // nothing but what is saved goes from step to step, so that a resumed run repeats this one
    Rigid::start_step(*system, system->touching, u);
    StepStatus status = solve_stages(t, t_next, next, work);
    if (status == StepStatus::linear_failed && assemble_instead())
      {
        next.u = first_guess(t_next - t);
        status = solve_stages(t, t_next, next, work);
      }
    if (status != StepStatus::ok)
      {
        last_dt = 0.; // the next, shorter step starts from the committed state, not from an extrapolation
        linear_solver->forget();
        system->touching.restore();
        system->end_step(v);
        return status;
      }
    last_increment = next.u;
    last_increment -= u;
    last_dt = t_next - t;
    u       = next.u;
    v       = next.v;
    commit(t_next);
    return StepStatus::ok;
  }

  template <int dim>
  void
  MpmMethod<dim>::commit(const double t)
  {
    time = t;
    collect_scalars(t);
    system->commit();
    system->end_step(v);

    const auto scope  = timers.scope("points");
    const auto policy = settings.policy_at(t);
    const bool reset  = policy == ResetPolicy::always ||
                       (policy == ResetPolicy::when_distorted && system->distortion(u) > settings.distortion_limit);
    if (!reset && settings.internal_force == InternalForce::consistent)
      return;
    system->rebase_points(u, reset);
    rebase_time = t;
    u           = 0.;
    if (!reset)
      return;
    reset_grid();
    system->end_step(v);
    warn_of_sparse_points(t);
  }

  template <int dim>
  void
  MpmMethod<dim>::reset_grid()
  {
    if (settings.weighs_points())
      points->split_stretched(
        [&](const unsigned int axis, const bool upper) { return motion->marks_of_inner_half(axis, upper); });
    points->move_to_their_cells();
    ++n_resets;
    system->rebuild();
    if (settings.weighs_points())
      set_weights(*points, *grid);
    is_whole = connected_parts().n_groups() <= n_parts;
    allocate();
    prepare_solver();
  }

  template <int dim>
  void
  MpmMethod<dim>::warn_of_sparse_points(const double t)
  {
    const double filling         = system->emptiest_inner_cell();
    const bool   is_interpolated = grid->shape->interpolates();
    if (sparse_told || filling > (is_interpolated ? sparse : sparse_for_splines))
      return;
    sparse_told = true;
    Log::warning("at t = " + brief(t) + " s a cell within the bodies is only " + brief(std::round(100 * filling)) +
                 " % full: its points were pulled apart, and forces may be wrong by as much as is missing" +
                 (is_interpolated ? "" : ", or, with B-splines, altogether") + "; use more " +
                 "'MPM/Points per cell' (or 'Points per voxel'), or 'MPM/Grid reset = never'");
  }

  template <int dim>
  void
  MpmMethod<dim>::collect_scalars(const double t)
  {
    scalars = reaction_scalars(scene, system->reactions(), t);
    for (const auto &result : system->rigid_results(u))
      scalars.push_back(result);
    scalars.emplace_back("strain_energy_J", system->strain_energy());
    if (motion->any_drives_points())
      scalars.emplace_back("largest_driven_gap_m", system->largest_driven_gap());
    if (settings.weighs_points())
      scalars.emplace_back("reset_misfit", misfit);
  }

  template class MpmMethod<2>;
  template class MpmMethod<3>;
} // namespace Stroma::Mpm
