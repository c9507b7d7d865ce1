#include <stroma/rigid/motion.h>
#include <stroma/scene/reactions.h>
#include <stroma/sph/particle_method.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    Settings
    read_settings(Parameters &p, const bool inertial, const bool has_contact)
    {
      const auto section = p.section(inertial ? "SPH" : "NSPH", inertial ?
                                                                  "smoothed particle hydrodynamics" :
                                                                  "smoothed particle hydrodynamics without inertia");
      Settings   settings;
      settings.add(p, inertial);
      if (has_contact || p.get_mode() == Parameters::Mode::document)
        settings.contact.add(p, settings.published());
      return settings;
    }

    /// Power that friction turns into heat [W over the thickness]. Of this rank.
    template <int dim>
    double
    dissipation(const System<dim> &system)
    {
      const auto                      &pairs = system.pairs;
      const auto                       v     = system.with_walls(system.particles.v);
      typename System<dim>::Velocities f(system.particles.n_free);
      system.add_friction(f, v);
      double power = 0.;
      for (unsigned int i = 0; i < system.particles.n_free; ++i)
        {
          power -= f[i] * v[i];
          for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
            power += system.friction_of_pair(i, p, v) * v[pairs.j[p]];
        }
      return system.thickness() * power;
    }
  } // namespace

  template <int dim>
  ParticleMethod<dim>::ParticleMethod(Parameters &p, const Scene<dim> &scene, const Dynamics dynamics,
                                      const double end_time, Timers &timers)
    : scene(scene)
    , timers(timers)
    , dynamics(dynamics)
    , end_time(end_time)
    , settings(read_settings(p, dynamics == Dynamics::inertial, !scene.contacts.empty()))
    , system(std::make_unique<System<dim>>(scene, settings, dynamics, end_time, timers))
  {
    facts.depends_on_rates = true;
    facts.point_fields     = {"displacement", "velocity", "von_mises", "pressure", "cauchy_stress", "J",
                              "material",     "volume",   "kernel_sum"};
    if (std::all_of(scene.media.begin(), scene.media.end(), [](const auto &medium) { return medium.density > 0.; }))
      facts.point_fields.push_back("density");
    if (!scene.degradations.empty())
      facts.point_fields.push_back("degradation_factor");
    if (!scene.is_fluid())
      facts.add_deformation_fields();
    if (scene.is_fluid())
      facts.sampled_fields = {"velocity", "von_mises", "pressure", "velocity_gradient"};
    else
      facts.sampled_fields = {"displacement",          "velocity",         "von_mises", "pressure", "cauchy_stress",
                              "displacement_gradient", "velocity_gradient"};
  }

  template <int dim>
  void
  ParticleMethod<dim>::setup(const Output::ArchiveReader *archive)
  {
    const bool as_it_was = archive && restore(*archive);
    if (!archive)
      {
        system->arrange();
        find_geometry();
        system->set_step(time - 1e-6 * end_time, time); // ends at the state, so that it has the loads of its time
      }
    prepare(as_it_was ? archive : nullptr);
    system->neighbours->update_ghosts(system->particles.v);
    if (!archive)
      collect_scalars(time);
    if (!archive && !ending.empty())
      throw UserError(scene.migrations.front().where, ending + ", already at the start; move it farther inside");
  }

  template <int dim>
  void
  ParticleMethod<dim>::find_geometry()
  {
    const auto status = system->update_geometry(true);
    if (status != StepStatus::ok)
      throw UserError(settings.arrangement.where_spacing,
                      (status == StepStatus::not_closed ? to_string(status) :
                                                          std::string("two particles lie on top of each other")) +
                        "; reduce 'Jitter' or take another 'Arrangement'");
  }

  template <int dim>
  void
  ParticleMethod<dim>::collect_scalars(const double t)
  {
    const auto reactions = system->reactions();
    scalars              = reaction_scalars(scene, reactions.of_supports, t);
    for (unsigned int m = 0; m < system->movers.size(); ++m)
      {
        const auto &mover           = system->movers[m];
        const auto &[force, torque] = reactions.of_movers[m];
        for (unsigned int c = 0; c < dim && mover.support < 0; ++c)
          scalars.emplace_back("reaction_" + mover.name + "_" + "xyz"[c] + "_N", force[c]);
        if (mover.rigid)
          for (const auto &result : mover.rigid->results(system->poses[m], force, torque))
            scalars.push_back(result);
        if (mover.rigid)
          for (const auto &result : Rigid::velocity_results(*mover.rigid, system->twists[m]))
            scalars.push_back(result);
      }
    for (const auto &scalar : system->contact_scalars())
      scalars.push_back(scalar);
    if (system->has_solids())
      scalars.emplace_back("strain_energy_J", system->strain_energy());
    collect_sums();
    if (dynamics == Dynamics::inertial && !system->is_supported() &&
        std::none_of(scene.periodic.begin(), scene.periodic.end(), [](const bool p) { return p; }))
      collect_momenta();
    for (const auto &scalar : system->process_scalars())
      scalars.push_back(scalar);
    ending = system->reason_to_end();
    if (system->has_solids())
      scalars.emplace_back("max_displacement_m", system->largest_displacement());
    double largest = 0.;
    for (unsigned int i = 0; i < system->particles.n_free; ++i)
      largest = std::max(largest, system->particles.v[i].norm());
    scalars.emplace_back("max_speed_m_per_s", dealii::Utilities::MPI::max(largest, scene.comm));
  }

  /// Of material that nothing holds; the angular momentum about the origin.
  template <int dim>
  void
  ParticleMethod<dim>::collect_momenta()
  {
    dealii::Tensor<1, dim> linear;
    Rigid::Axial<dim>      angular;
    const auto            &particles = system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        const auto mv = system->thickness() * system->mass(i) * particles.v[i];
        linear += mv;
        angular += Rigid::moment<dim>(particles.X[i] + system->displacement(i), mv);
      }
    linear  = dealii::Utilities::MPI::sum(linear, scene.comm);
    angular = dealii::Utilities::MPI::sum(angular, scene.comm);
    for (unsigned int c = 0; c < dim; ++c)
      scalars.emplace_back(std::string("momentum_") + "xyz"[c] + "_Ns", linear[c]);
    for (unsigned int a = 0; a < Rigid::n_rotations<dim>; ++a)
      scalars.emplace_back(dim == 2 ? "angular_momentum_Nms" : std::string("angular_momentum_") + "xyz"[a] + "_Nms",
                           angular[a]);
  }

  /// Kinetic energy; of fluids also flow rates and dissipation.
  template <int dim>
  void
  ParticleMethod<dim>::collect_sums()
  {
    const bool inertial = dynamics == Dynamics::inertial, is_fluid = !system->has_solids();
    if (!inertial && !is_fluid)
      return;
    std::vector<double> sums(dim + 2); // kinetic energy, dissipation, volume integrals of v
    const auto         &particles = system->particles;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        const auto &v = particles.v[i];
        sums[0] += .5 * system->thickness() * system->mass(i) * v.norm_square();
        for (unsigned int d = 0; d < dim; ++d)
          sums[2 + d] += system->thickness() * particles.volume(i) * v[d];
      }
    if (is_fluid)
      sums[1] = dissipation(*system);
    dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    if (inertial)
      scalars.emplace_back("kinetic_energy_J", sums[0] + system->energy_of_bodies());
    if (!is_fluid)
      return;
    const auto box = scene.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      scalars.emplace_back(std::string("flow_rate_") + "xyz"[d] + "_m3_per_s", sums[2 + d] / box.side_length(d));
    scalars.emplace_back("dissipation_W", sums[1]);
    if (system->packing)
      scalars.emplace_back("crowding", system->packing->mean_excess(system->particles));
  }

  template class ParticleMethod<2>;
  template class ParticleMethod<3>;
} // namespace Stroma::Sph
