#include <stroma/sph/size.h>
#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    /// Room for moves between two searches for neighbours, over the spacing.
    constexpr double skin_over_spacing = .3;

    /// Move, over the spacing, after which pair geometry is found anew.
    constexpr double geometry_tolerance = 1e-3;

    const char *
    name_of(const Dynamics dynamics)
    {
      return dynamics == Dynamics::inertial ? "sph" : "nsph";
    }

    template <int dim>
    std::vector<Constitution>
    checked_constitutions(const Scene<dim> &scene, const Settings &settings, const Dynamics dynamics)
    {
      typename Scene<dim>::Abilities can;
      can.fluids = can.viscosity = can.contact = can.contact_friction = can.rigid_bodies = can.rigid_rotations =
        can.periodic = can.velocities = true;
      can.rate_laws                   = true;
      can.rigid_forces = can.rigid_torques = can.rigid_drag = can.rigid_masses = can.migration = true;
      can.rigid_approach = dynamics == Dynamics::overdamped;
      can.inertia        = dynamics == Dynamics::inertial;
      can.total_laws     = false;
      can.degradation    = dynamics == Dynamics::overdamped;
      scene.require(name_of(dynamics), can);
      return constitutions_of(scene, name_of(dynamics), settings.published(), dynamics == Dynamics::inertial);
    }
  } // namespace

  /// Throws UserError for what degradation does not go with.
  template <int dim>
  static void
  require_degradation_can(const Scene<dim> &scene, const Settings &settings)
  {
    if (scene.degradations.empty())
      return;
    const auto refuse = [&](const std::string &why) { throw UserError(scene.degradations.front().where, why); };
    if (settings.published())
      refuse("degradation needs 'Formulation = consistent'");
    if (!scene.contacts.empty())
      refuse("with degradation rigid bodies are bonded to what is around them; remove section Contact");
    if (scene.materials.size() > 1)
      refuse("with degradation there is one material; remove the others");
  }

  /// Throws UserError for what walls of facets cannot do.
  template <int dim>
  static void
  require_facets_can(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers)
  {
    for (const auto &mover : movers)
      if (!mover.rigid && mover.varies_in_space && !mover.gives_displacement)
        throw UserError(scene.supports[mover.support].where,
                        "support '" + mover.name +
                          "' moves its side with a velocity that varies along it, which facets cannot follow; give its "
                          "'Displacement', or set 'Walls = layers'");
  }

  /// Throws UserError for what the published walls of segments cannot do.
  static void
  require_segments_can(const unsigned int dimension, const Settings &settings)
  {
    if (dimension != 2)
      throw UserError(
        settings.where_walls,
        "the published scheme has boundary particles and segments in the plane only; set 'Walls = layers'");
  }

  template <int dim>
  System<dim>::System(const Scene<dim> &scene, const Settings &settings, const Dynamics dynamics, const double end_time,
                      Timers &timers)
    : scene(scene)
    , settings(settings)
    , constitutions(checked_constitutions(scene, settings, dynamics))
    , movers(movers_of(scene, end_time, settings.arrangement.spacing))
    , pairs(scene, movers, settings)
    , is_inertial(dynamics == Dynamics::inertial)
    , end_time(end_time)
    , timers(timers)
  {
    if (settings.has_segments())
      require_segments_can(dim, settings);
    else if (settings.walls == Walls::facets)
      require_facets_can(scene, movers);
    require_degradation_can(scene, settings);
    check_size(scene, settings, dynamics == Dynamics::inertial);
    const double dp      = settings.arrangement.spacing;
    const double support = with_kernel<dim>(settings.kernel, settings.h(),
                                            [](const auto &kernel) { return kernel.support(); });
    neighbours           = std::make_unique<Neighbours<dim>>(
      typename Neighbours<dim>::Settings{support, skin_over_spacing * dp, scene.periodic, scene.bounding_box(),
                                         settings.published(), scene.where_periodic},
      scene.comm);
    if (!scene.contacts.empty())
      contacts = std::make_unique<Contacts<dim>>(scene, movers, settings);
    for (const auto &mover : movers)
      poses.push_back(mover.rigid ? mover.rigid->pose(0.) : Rigid::Pose<dim>());
    pairs_poses = poses;
    steps.resize(movers.size());
    twists.resize(movers.size());
    if (std::any_of(movers.begin(), movers.end(),
                    [](const auto &mover) { return mover.rigid && mover.rigid->drive.is_by_balance(); }))
      bodies = std::make_unique<BodyBalance<dim>>(scene, movers);
    momenta.resize(movers.size());
    for (unsigned int m = 0; m < movers.size() && dynamics == Dynamics::inertial; ++m)
      if (bodies && bodies->moves(m))
        {
          if (const auto &start = scene.bodies[movers[m].rigid->body].initial_velocity; start.given())
            twists[m].velocity = start.value(movers[m].rigid->pivot, 0.);
          momenta[m].emplace(*movers[m].rigid, bodies->masses()[m], twists[m], poses[m]);
        }
  }

  template <int dim>
  void
  System<dim>::arrange()
  {
    {
      const auto   scope            = timers.scope("particles");
      const double dp               = settings.arrangement.spacing;
      const double reach            = with_kernel<dim>(settings.kernel, settings.h(),
                                            [](const auto &kernel) { return kernel.support(); });
      auto         arrangement      = settings.arrangement;
      arrangement.follows_borders   = has_interfaces();
      arrangement.bodies_by_surface = settings.has_segments();
      particles = Sph::arrange(scene, arrangement, movers, settings.has_layers() ? reach + .5 * dp : 0.);
      start_fields();
    }
    count();
    make_parts();
  }

  template <int dim>
  void
  System<dim>::restore(ParticleSet<dim> &&owned)
  {
    particles = std::move(owned);
    count();
    make_parts();
  }

  template <int dim>
  void
  System<dim>::start_fields()
  {
    const unsigned int n = particles.size();
    particles.v.assign(n, {});
    particles.x_search = particles.x;
    if (has_solids())
      particles.S.assign(n, {});
    if (!settings.published())
      particles.closure.assign(n, {});
    start_degradation();
    if ((!has_solids() || !scene.degradations.empty()) && !settings.published())
      particles.excess.assign(n, Packing<dim>::not_found);
    if (contacts)
      contacts->start(particles);
  }

  template <int dim>
  void
  System<dim>::count()
  {
    n_free  = dealii::Utilities::MPI::sum(std::uint64_t(particles.n_free), scene.comm);
    n_fixed = dealii::Utilities::MPI::sum(std::uint64_t(particles.n_owned - particles.n_free), scene.comm);
  }

  /// Whether each mover is a body that degrades; empty where none does.
  template <int dim>
  std::vector<bool>
  System<dim>::degrading_movers() const
  {
    std::vector<bool> degrading;
    for (unsigned int m = 0; m < movers.size() && !scene.degradations.empty(); ++m)
      degrading.push_back(std::any_of(scene.degradations.begin(), scene.degradations.end(), [&](const auto &d) {
        return movers[m].rigid && movers[m].rigid->body == d.body;
      }));
    return degrading;
  }

  template <int dim>
  void
  System<dim>::make_parts()
  {
    const double dp         = settings.arrangement.spacing;
    const bool   is_viscous = std::any_of(constitutions.begin(), constitutions.end(),
                                          [](const auto &c) { return c.mu > 0.; });
    const auto   degrading  = degrading_movers();
    if (!settings.published())
      area_vectors = std::make_unique<AreaVectors<dim>>(*neighbours, dp, scene.is_fluid(), settings.closing_tolerance,
                                                        settings.walls == Walls::facets ? std::vector<bool>() :
                                                                                          degrading,
                                                        scene.comm);
    const auto form = scene.media.front().viscous_operator;
    is_smooth       = is_viscous && !settings.published() && form == Materials::ViscousOperator::central;
    if (is_viscous && !is_smooth)
      friction = std::make_unique<Friction<dim>>(pairs, constitutions, form);
    if (has_interfaces())
      interfaces = std::make_unique<Interfaces<dim>>(scene, constitutions, *neighbours, settings.stabilisation);
    if (!scene.degradations.empty())
      {
        degraded          = std::make_unique<DegradedShear<dim>>(pairs, *neighbours, particles, degrading);
        degraded_friction = std::make_unique<DegradedFriction<dim>>(pairs, *neighbours, particles,
                                                                    constitutions.front().mu);
      }
    elasticity = std::make_unique<Elasticity<dim>>(pairs, *neighbours, constitutions,
                                                   settings.published() ? 0. : settings.stabilisation,
                                                   !settings.published(),
                                                   scene.is_fluid() && !settings.published() && has_walls(),
                                                   interfaces.get(), degraded.get(), degraded_friction.get());
    if (has_solids() && !settings.published())
      hourglass_control = std::make_unique<HourglassControl<dim>>(pairs, *neighbours, *elasticity, interfaces.get());
    if ((!has_solids() || degraded) && !settings.published())
      packing = std::make_unique<Packing<dim>>(pairs, *neighbours, settings);
    loads = std::make_unique<Loads<dim>>(scene, particles, dp, end_time);
    if (pairs.has_segments())
      boundary_stress = std::make_unique<BoundaryStress<dim>>(pairs, *neighbours, settings);
  }

  template <int dim>
  StepStatus
  System<dim>::update_geometry(const bool anew)
  {
    undrawn.reset();
    const auto status = anew || has_moved() ? renew_geometry(anew) : StepStatus::ok;
    if (status == StepStatus::ok)
      draw_to_strain_of_places();
    return status;
  }

  template <int dim>
  StepStatus
  System<dim>::renew_geometry(const bool anew)
  {
    if (!anew && neighbours->n_rebuilds > 0 && !neighbours->outdated(particles))
      return find_pairs_here();
    {
      const auto scope = timers.scope("neighbours");
      neighbours->rebuild(particles, anew);
      loads->find(particles);
    }
    return find_pairs(anew);
  }

  /// Of the neighbours that there are, where particles are now.
  template <int dim>
  StepStatus
  System<dim>::find_pairs_here()
  {
    neighbours->update_ghost_places(particles.x);
    neighbours->update_ghosts(particles.J);
    return find_pairs(false);
  }

  /// Of the neighbours that there are.
  template <int dim>
  StepStatus
  System<dim>::find_pairs(const bool from_scratch)
  {
    particles.x_pairs.clear();
    particles.J_pairs.clear();
    pairs_poses = poses;
    pairs_time  = now;
    ++n_pairings;
    const auto scope  = timers.scope("pairs");
    auto       status = pairs.update(particles, *neighbours, now, poses);
    if (interfaces)
      interfaces->find(pairs, particles);
    if (status == StepStatus::ok && area_vectors)
      status = area_vectors->close(pairs, particles, from_scratch);
    if (interfaces)
      interfaces->take(pairs, particles);
    set_coefficients();
    if (status != StepStatus::ok)
      return status;
    particles.x_pairs = particles.x;
    particles.J_pairs = particles.J;
    return StepStatus::ok;
  }

  /// For the pairs as they are.
  template <int dim>
  void
  System<dim>::set_coefficients()
  {
    if (!settings.published())
      pairs.leave_out_touching();
    if (friction)
      friction->update(particles);
    elasticity->update(particles);
    if (hourglass_control)
      hourglass_control->update(particles, wall_displacements(pairs_poses, pairs_time));
    if (packing)
      packing->update(particles);
    if (bodies)
      bodies->update(particles, pairs, pairs_poses);
    find_wall_velocities();
    L.resize(pairs.n_rows());
  }

  template <int dim>
  void
  System<dim>::restore_pairs(const double found_at, const unsigned int n_in_order)
  {
    neighbours->restore(particles, n_in_order);
    loads->find(particles);
    swap_with_pairs();
    neighbours->update_ghost_places(particles.x);
    pairs_time = found_at;
    pairs.update(particles, *neighbours, pairs_time, pairs_poses);
    if (interfaces)
      interfaces->find(pairs, particles);
    if (area_vectors)
      area_vectors->apply(pairs, particles);
    if (interfaces)
      interfaces->take(pairs, particles);
    set_coefficients();
    swap_with_pairs();
  }

  /// Places and density ratios of the owned particles with those of the pairs. Ghosts are then as the owned ones.
  template <int dim>
  void
  System<dim>::swap_with_pairs()
  {
    std::swap_ranges(particles.x.begin(), particles.x.begin() + particles.n_owned, particles.x_pairs.begin());
    std::swap_ranges(particles.J.begin(), particles.J.begin() + particles.n_owned, particles.J_pairs.begin());
    neighbours->update_ghosts(particles.J);
  }

  template <int dim>
  bool
  System<dim>::has_moved() const
  {
    const bool has_pairs = particles.x_pairs.size() == particles.size();
    double     move      = has_pairs ? std::pow(move_of_facets(), 2) : std::numeric_limits<double>::max();
    for (unsigned int i = 0; has_pairs && i < particles.n_owned; ++i)
      move = std::max(move, (particles.x[i] - particles.x_pairs[i]).norm_square());
    const double room = geometry_tolerance * settings.arrangement.spacing;
    return dealii::Utilities::MPI::max(move, scene.comm) > room * room;
  }

  template <int dim>
  Tensor<1, dim>
  System<dim>::displacement(const unsigned int i) const
  {
    return neighbours->image_near(particles.x[i], particles.X[i]) - particles.X[i];
  }

  template <int dim>
  double
  System<dim>::largest_displacement() const
  {
    double largest = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      largest = std::max(largest, displacement(i).norm());
    return dealii::Utilities::MPI::max(largest, scene.comm);
  }

  template class System<2>;
  template class System<3>;
} // namespace Stroma::Sph
