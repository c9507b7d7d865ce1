// Contacts of System: pairs that come and go, the forces in them, and what is told of them.

#include <stroma/rigid/contact_results.h>
#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  using dealii::Tensor;

  template <int dim>
  StepStatus
  System<dim>::start_contacts(const bool by_places, bool &changed)
  {
    changed = false;
    if (!contacts)
      return StepStatus::ok;
    contacts->start_step(particles);
    if (!by_places && !contacts->is_of_places() && !contacts->has_friction())
      return StepStatus::ok;
    const auto v      = with_walls(particles.v);
    const auto motion = contact_motion(v, v, 0.);
    if (contacts->has_friction())
      contacts->find_friction(particles, pairs, motion);
    if (!by_places && !contacts->is_of_places())
      return StepStatus::ok;
    changed = contacts->change(particles, pairs, *neighbours, poses, motion);
    return changed ? find_pairs_here() : StepStatus::ok;
  }

  template <int dim>
  StepStatus
  System<dim>::change_contacts(const Velocities &mean, const Velocities &end, const double dt, bool &changed)
  {
    changed = contacts->change(particles, pairs, *neighbours, poses, contact_motion(mean, end, dt));
    return changed ? find_pairs_here() : StepStatus::ok;
  }

  /// What particles and bodies do to each other with velocities @p mean over a step of @p dt, of which refer those of bodies, and @p end
  /// at its end.
  template <int dim>
  typename Contacts<dim>::Motion
  System<dim>::contact_motion(const Velocities &mean, const Velocities &end, const double dt) const
  {
    typename Contacts<dim>::Motion motion;
    motion.forces = contact_forces(mean, end, dt);
    motion.dt     = dt;
    motion.noise  = residual;
    motion.of     = [this, &mean](const unsigned int i, const unsigned int m, const dealii::Point<dim> &X) {
      return t_next > t ? mean[i] - wall_velocity(m, X) : dealii::Tensor<1, dim>();
    };
    motion.of_body = [this](const unsigned int m, const dealii::Point<dim> &X) {
      return t_next > t ? wall_velocity(m, X) : dealii::Tensor<1, dim>();
    };
    return motion;
  }

  template <int dim>
  void
  System<dim>::restore_contacts()
  {
    if (!contacts)
      return;
    const bool differs = contacts->restore(particles);
    if (dealii::Utilities::MPI::max(differs ? 1 : 0, scene.comm) == 1)
      find_pairs_here(); // those of a checkpoint made now
  }

  /// On the material, of each of pairs.touching: of the state's stress and what velocities @p mean over @p dt add to it, and of the
  /// friction of velocities @p end.
  template <int dim>
  typename System<dim>::Velocities
  System<dim>::contact_forces(const Velocities &mean, const Velocities &end, const double dt) const
  {
    Velocities forces(pairs.touching.size()), f(particles.n_free);
    const auto add = [&](const Velocities &u) {
      for (std::size_t e = 0; e < forces.size(); ++e)
        forces[e] += elasticity->pair_force(pairs.touching[e].i, pairs.touching[e].p, u);
    };
    elasticity->add_stress_force(f, stresses(), &particles.S);
    add(mean);
    if (dt > 0.)
      {
        elasticity->combine(dt, 0.);
        elasticity->add_stiffness_force(f, mean);
        add(mean);
      }
    add_friction(f, end);
    for (std::size_t e = 0; e < forces.size(); ++e)
      forces[e] += friction_of_pair(pairs.touching[e].i, pairs.touching[e].p, end);
    return forces;
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  System<dim>::contact_scalars()
  {
    std::vector<std::pair<std::string, double>> result;
    if (!contacts)
      return result;
    const auto v      = with_walls(particles.v);
    const auto forces = contact_forces(v, v, 0.);
    for (unsigned int c = 0; c < scene.contacts.size(); ++c)
      {
        Rigid::ContactResults<dim> told;
        for (std::size_t e = 0; e < forces.size();)
          {
            const unsigned int i = pairs.touching[e].i;
            Tensor<1, dim>     force, missing; // area vector
            for (; e < forces.size() && pairs.touching[e].i == i; ++e)
              if (pairs.touching[e].contact == c)
                {
                  force += forces[e];
                  missing += (settings.published() ? 1. : .5) * pairs.c[pairs.touching[e].p];
                }
            if (missing.norm() == 0.)
              continue;
            force /= pairs.row_factor(i);
            missing /= pairs.row_factor(i);
            if (const auto more = contacts->forces().find({i, c}); more != contacts->forces().end())
              force += more->second.force;
            told.force -= thickness() * force;
            told.area += thickness() * missing.norm();
            if (settings.contact.criterion == ContactCriterion::surface &&
                (particles.contact[i] & ContactState::primary(c)) == 0)
              continue; // it is below the surface
            told.profile.push_back({{particles.x[i][0], -(force * missing) / missing.norm_square()}});
          }
        const std::string &name = scene.bodies[scene.contacts[c].body].name;
        for (const auto &scalar : told.named(name, scene.comm))
          result.push_back(scalar);
        result.emplace_back("contact_particles_" + name,
                            dealii::Utilities::MPI::sum(double(told.profile.size()), scene.comm));
      }
    return result;
  }

#define INSTANTIATE(dim)                                                                                               \
  template StepStatus System<dim>::start_contacts(bool, bool &);                                                       \
  template StepStatus System<dim>::change_contacts(const Velocities &, const Velocities &, double, bool &);            \
  template void       System<dim>::restore_contacts();                                                                 \
  template typename Contacts<dim>::Motion System<dim>::contact_motion(const Velocities &, const Velocities &, double)  \
    const;                                                                                                             \
  template typename System<dim>::Velocities System<dim>::contact_forces(const Velocities &, const Velocities &,        \
                                                                        double) const;                                 \
  template std::vector<std::pair<std::string, double>> System<dim>::contact_scalars();
  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Stroma::Sph
