#include <stroma/sph/system.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  template <int dim>
  std::vector<SymmetricTensor<2, dim>>
  System<dim>::stresses() const
  {
    std::vector<SymmetricTensor<2, dim>> sigma(particles.size());
    for (unsigned int i = 0; i < particles.size(); ++i)
      {
        if (particles.is_fixed(i) && !settings.published())
          continue;
        if (!particles.S.empty())
          sigma[i] = particles.S[i];
        const double p = constitutions[material_of(i)].pressure(particles.J[i]);
        for (unsigned int d = 0; d < dim; ++d)
          sigma[i][d][d] -= p;
      }
    if (boundary_stress)
      boundary_stress->add(sigma, particles, loads->last_force());
    return sigma;
  }

  template <int dim>
  void
  System<dim>::state_forces(Velocities &f, const double load_time)
  {
    f.assign(particles.n_free, {});
    const auto &external = loads->force(particles, load_time);
    elasticity->add_stress_force(f, stresses(), &particles.S);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      f[i] += pairs.row_factor(i) * external[i];
    if (contacts)
      for (const auto &[where, force] : contacts->forces())
        f[where.first] += pairs.row_factor(where.first) * force.force;
    find_hourglass_forces();
    if (hourglass_control)
      hourglass_control->add_forces(f);
  }

  template <int dim>
  void
  System<dim>::find_hourglass_forces()
  {
    if (!hourglass_control)
      return;
    neighbours->update_ghost_places(particles.x);
    hourglass_control->find_forces(particles, wall_displacements(poses, now));
  }

  template <int dim>
  void
  System<dim>::find_state_forces(const double load_time)
  {
    loads->force(particles, load_time);
    elasticity->set_stresses(stresses(), &particles.S);
    find_hourglass_forces();
  }

  template <int dim>
  void
  System<dim>::add_friction(Velocities &f, const Velocities &v) const
  {
    if (friction)
      friction->add_force(f, v);
    if (is_smooth)
      {
        elasticity->combine(0., 1.);
        elasticity->add_stiffness_force(f, v);
      }
  }

  template <int dim>
  void
  System<dim>::forces(Velocities &f, const Velocities &v, const double load_time)
  {
    if (!is_smooth || !hourglass_control || interfaces || degraded || contacts)
      {
        state_forces(f, load_time);
        add_friction(f, v);
        return;
      }
    f = loads->force(particles, load_time);
    elasticity->set_stresses(stresses());
    find_hourglass_forces();
    elasticity->combine(0., 1.);
    elasticity->add_increment(v);
    elasticity->add_forces_with(f, v, hourglass_control->rows());
  }

  template <int dim>
  void
  System<dim>::find_friction(const Velocities &v) const
  {
    if (!is_smooth)
      return;
    elasticity->combine(0., 1.);
    elasticity->set_increment(v);
  }

  template <int dim>
  Tensor<1, dim>
  System<dim>::friction_of_pair(const unsigned int i, const std::size_t p, const Velocities &v) const
  {
    if (friction)
      return friction->pair_force(p, v[pairs.j[p]] - v[i]);
    return is_smooth ? elasticity->pair_force(i, p, v) : Tensor<1, dim>();
  }

  template <int dim>
  double
  System<dim>::strain_energy() const
  {
    double energy = 0.;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        const Constitution &law = constitutions[material_of(i)];
        const double        p   = law.pressure(particles.J[i]);
        double              w   = .5 * p * p / law.K;
        if (law.G > 0.)
          {
            const auto  &S   = particles.S[i];
            const double S_z = dim == 2 ? trace(S) : 0.;
            w += (S * S + S_z * S_z) / (4. * law.G);
          }
        energy += w * particles.V0[i];
      }
    if (hourglass_control)
      energy += hourglass_control->energy();
    return thickness() * dealii::Utilities::MPI::sum(energy, scene.comm);
  }

#define INSTANTIATE(dim)                                                                                               \
  template std::vector<SymmetricTensor<2, dim>> System<dim>::stresses() const;                                         \
  template void                                 System<dim>::state_forces(Velocities &, double);                       \
  template void                                 System<dim>::find_hourglass_forces();                                  \
  template void                                 System<dim>::find_state_forces(double);                                \
  template void                                 System<dim>::add_friction(Velocities &, const Velocities &) const;     \
  template void                                 System<dim>::forces(Velocities &, const Velocities &, double);         \
  template void                                 System<dim>::find_friction(const Velocities &) const;                  \
  template Tensor<1, dim> System<dim>::friction_of_pair(unsigned int, std::size_t, const Velocities &) const;          \
  template double         System<dim>::strain_energy() const;
  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Stroma::Sph
