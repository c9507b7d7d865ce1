// Rigid bodies of System that propel themselves and degrade what is around them.

#include <stroma/base/text.h>
#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  namespace
  {
    template <int dim>
    unsigned int
    mover_of_body(const std::vector<Mover<dim>> &movers, const unsigned int body)
    {
      unsigned int m = 0;
      while (!movers[m].rigid || movers[m].rigid->body != body)
        ++m;
      return m;
    }

    /// Of particles from a body that degrades, over the spacing; as far as a repulsion that acts below .7 of it from the first layer of
    /// particles behind the surface (Heck 2017, 3.4).
    constexpr double least_gap = .2;

    /// Half way between two poses.
    template <int dim>
    Rigid::Pose<dim>
    between(Rigid::Pose<dim> a, const Rigid::Pose<dim> &b)
    {
      a.translation = .5 * (a.translation + b.translation);
      a.rotation    = .5 * (a.rotation + b.rotation);
      return a;
    }

    /// Whether two boxes are less than @p reach apart.
    template <int dim>
    bool
    meet(const dealii::BoundingBox<dim> &a, const dealii::BoundingBox<dim> &b, const double reach)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (a.lower_bound(d) > b.upper_bound(d) + reach || b.lower_bound(d) > a.upper_bound(d) + reach)
          return false;
      return true;
    }
  } // namespace

  template <int dim>
  void
  System<dim>::start_degradation()
  {
    if (scene.degradations.empty())
      return;
    particles.intact.assign(particles.size(), 1.);
    if (!settings.published())
      particles.open.assign(particles.size(), AreaVectors<dim>::not_found);
    for (const auto &degradation : scene.degradations)
      {
        const auto &shape = *scene.bodies[degradation.body].shape;
        for (unsigned int i = 0; i < particles.n_free; ++i)
          particles.intact[i] = std::min(particles.intact[i], degradation.at_start(shape, particles.X[i]));
      }
  }

  /// At the end of a step: by where particles and bodies were in its middle. The shear stress relaxes in proportion.
  template <int dim>
  void
  System<dim>::degrade(const double dt)
  {
    for (const auto &degradation : scene.degradations)
      {
        const unsigned int m     = mover_of_body(movers, degradation.body);
        const auto        &shape = *scene.bodies[degradation.body].shape;
        const auto         pose  = between(steps[m]->from, poses[m]);
        for (unsigned int i = 0; i < particles.n_free; ++i)
          {
            const double f = particles.intact[i];
            if (f == 0.)
              continue;
            const auto   x = particles.x[i] - .5 * dt * particles.v[i];
            const double g = degradation.after(f, shape, pose, x, t_next - .5 * dt, dt);
            if (g < f)
              particles.S[i] *= g / f;
            particles.intact[i] = g;
          }
      }
    neighbours->update_ghosts(particles.intact);
    elasticity->update_degradation();
    hourglass_control->set_stiffness();
  }

  /// What rigid body @p body takes up now, along the axes.
  template <int dim>
  dealii::BoundingBox<dim>
  System<dim>::box_of(const unsigned int body) const
  {
    const auto                     &pose = poses[mover_of_body(movers, body)];
    std::vector<dealii::Point<dim>> places;
    for (const auto &facet : scene.bodies[body].shape->facets(settings.h()))
      for (const auto &X : facet.corners)
        places.push_back(pose.place(X));
    return dealii::BoundingBox<dim>(places);
  }

  /// Of the place @p x now from the surface of rigid body @p body.
  template <int dim>
  double
  System<dim>::distance_of(const unsigned int body, const dealii::Point<dim> &x) const
  {
    const auto &pose = poses[mover_of_body(movers, body)];
    const auto  arm  = x - pose.pivot - pose.translation;
    return scene.bodies[body].shape->distance(pose.pivot + transpose(Rigid::rotation_matrix<dim>(pose.rotation)) * arm);
  }

  /// The way from @p x to where no body that degrades is too near [m].
  template <int dim>
  dealii::Tensor<1, dim>
  System<dim>::off_bodies(const dealii::Point<dim> &x) const
  {
    dealii::Tensor<1, dim> way;
    for (const auto &degradation : scene.degradations)
      {
        const auto  &pose     = poses[mover_of_body(movers, degradation.body)];
        const auto   rotation = Rigid::rotation_matrix<dim>(pose.rotation);
        const auto   arm      = x + way - pose.pivot - pose.translation;
        const auto   at       = scene.bodies[degradation.body].shape->nearest(pose.pivot + transpose(rotation) * arm);
        const double missing  = least_gap * settings.arrangement.spacing - at.distance;
        if (missing > 0.)
          way += missing * (rotation * at.normal);
      }
    return way;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  System<dim>::process_scalars() const
  {
    std::vector<std::pair<std::string, double>> result;
    for (const auto &migration : scene.migrations)
      {
        const auto   &name    = scene.bodies[migration.body].name;
        const auto   &pose    = poses[mover_of_body(movers, migration.body)];
        std::uint64_t inside  = 0;
        double        nearest = std::numeric_limits<double>::max();
        for (unsigned int i = 0; i < particles.n_free; ++i)
          {
            const double d = distance_of(migration.body, particles.x[i]);
            inside += d < 0. ? 1 : 0;
            nearest = std::min(nearest, d);
          }
        result.emplace_back("mean_speed_" + name + "_m_per_s", now > 0. ? pose.translation.norm() / now : 0.);
        result.emplace_back("particles_inside_" + name, dealii::Utilities::MPI::sum(inside, scene.comm));
        result.emplace_back("nearest_particle_" + name + "_m", dealii::Utilities::MPI::min(nearest, scene.comm));
      }
    if (!degraded)
      return result;
    std::vector<double> sums(3); // volumes at the start, now, and of what has become a fluid
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        sums[0] += particles.V0[i];
        sums[1] += particles.volume(i);
        sums[2] += (1. - particles.intact[i]) * particles.volume(i);
      }
    dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    result.emplace_back("volume_change", sums[1] / sums[0] - 1.);
    result.emplace_back("degraded_share", sums[2] / sums[1]);
    result.emplace_back("crowding", packing->mean_excess(particles));
    return result;
  }

  template <int dim>
  std::string
  System<dim>::reason_to_end() const
  {
    const double reach  = with_kernel<dim>(settings.kernel, settings.h(),
                                          [](const auto &kernel) { return kernel.support(); });
    const auto   matrix = scene.bounding_box();
    for (const auto &migration : scene.migrations)
      {
        const std::string &name = scene.bodies[migration.body].name;
        const auto         box  = box_of(migration.body);
        for (unsigned int d = 0; d < dim; ++d)
          if (box.lower_bound(d) < matrix.lower_bound(d) + reach || box.upper_bound(d) > matrix.upper_bound(d) - reach)
            return "rigid body '" + name + "' has reached the edge of the material along " + "xyz"[d] + ", to " +
                   brief(reach) + " m, the reach of particles";
        for (const auto &rigid : scene.rigid_bodies)
          if (rigid.body != migration.body && meet(box, box_of(rigid.body), reach))
            return "rigid bodies '" + name + "' and '" + rigid.name + "' have come together to " + brief(reach) +
                   " m, the reach of particles";
      }
    return "";
  }

  template void                   System<2>::start_degradation();
  template void                   System<2>::degrade(double);
  template dealii::BoundingBox<2> System<2>::box_of(unsigned int) const;
  template double                 System<2>::distance_of(unsigned int, const dealii::Point<2> &) const;
  template dealii::Tensor<1, 2>   System<2>::off_bodies(const dealii::Point<2> &) const;
  template std::vector<std::pair<std::string, double>> System<2>::process_scalars() const;
  template std::string                                 System<2>::reason_to_end() const;
  template void                                        System<3>::start_degradation();
  template void                                        System<3>::degrade(double);
  template dealii::BoundingBox<3>                      System<3>::box_of(unsigned int) const;
  template double               System<3>::distance_of(unsigned int, const dealii::Point<3> &) const;
  template dealii::Tensor<1, 3> System<3>::off_bodies(const dealii::Point<3> &) const;
  template std::vector<std::pair<std::string, double>> System<3>::process_scalars() const;
  template std::string                                 System<3>::reason_to_end() const;
} // namespace Stroma::Sph
