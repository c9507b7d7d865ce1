#include <stroma/sph/boundary_stress.h>

namespace Stroma::Sph
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    /// Largest distance of a boundary particle from the plane of the part of a wall that it counts for, over the spacing.
    constexpr double thickness_of_part = .5;
  } // namespace

  template <int dim>
  BoundaryStress<dim>::BoundaryStress(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                                      const Settings &settings)
    : pairs(pairs)
    , neighbours(neighbours)
    , settings(settings)
  {}

  template <int dim>
  bool
  BoundaryStress<dim>::gives(const ParticleSet<dim> &particles, const unsigned int i) const
  {
    return particles.is_fixed(i) && pairs.is_rigid(particles.mover[i]);
  }

  template <int dim>
  void
  BoundaryStress<dim>::add(Stresses &sigma, const ParticleSet<dim> &particles,
                           const std::vector<Tensor<1, dim>> &body_forces) const
  {
    auto forces = body_forces;
    forces.resize(particles.size());
    neighbours.update_ghosts(forces);
    with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) {
      for (unsigned int b = particles.n_free; b < particles.n_owned; ++b)
        if (gives(particles, b))
          sigma[b] = at_particle(b, sigma, particles, forces, kernel);
      neighbours.update_ghosts(sigma);
      sigma.resize(pairs.n_points());
      for (unsigned int i = 0; i < particles.n_free; ++i)
        for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
          if (pairs.meets_wall_point(p))
            sigma[pairs.j[p]] = at_segments(i, p, sigma, particles, kernel);
    });
  }

  /// (30) to (32); 0 where no material touches.
  template <int dim>
  template <typename KernelType>
  SymmetricTensor<2, dim>
  BoundaryStress<dim>::at_particle(const unsigned int b, const Stresses &sigma, const ParticleSet<dim> &particles,
                                   const std::vector<Tensor<1, dim>> &forces, const KernelType &kernel) const
  {
    double                  mass = 0., volume = 0.; // density is in units of that of the undeformed material
    SymmetricTensor<2, dim> sum;
    for (unsigned int p = pairs.row_start[b]; p < pairs.row_fixed[b]; ++p)
      {
        const unsigned int j = pairs.j[p];
        const double       W = kernel.W(pairs.r[p].norm());
        mass += particles.V0[j] * W;
        volume += particles.volume(j) * W;
        sum += particles.volume(j) * W *
               (particles.J[j] * sigma[j] +
                (forces[j] * pairs.r[p]) / particles.V0[j] * dealii::unit_symmetric_tensor<dim>());
      }
    return volume > 0. ? mass / (volume * volume) * sum : SymmetricTensor<2, dim>();
  }

  /// The part of a wall at which pair @p p of row @p i ends; where no boundary particle is seen on it, the stress of i.
  template <int dim>
  template <typename KernelType>
  SymmetricTensor<2, dim>
  BoundaryStress<dim>::at_segments(const unsigned int i, const std::size_t p, const Stresses &sigma,
                                   const ParticleSet<dim> &particles, const KernelType &kernel) const
  {
    const auto             &wall    = pairs.wall(p);
    const auto              to_wall = -wall.gap * wall.normal;
    double                  weight  = 0.;
    SymmetricTensor<2, dim> sum;
    for (unsigned int q = pairs.row_fixed[i]; q < p; ++q)
      {
        const unsigned int b = pairs.j[q];
        if (pairs.meets_wall_point(q) || particles.mover[b] != wall.mover ||
            std::abs((pairs.r[q] - to_wall) * wall.normal) > thickness_of_part * settings.arrangement.spacing)
          continue;
        const double W = kernel.W(pairs.r[q].norm());
        weight += W;
        sum += W * sigma[b];
      }
    return weight > 0. ? sum / weight : sigma[i];
  }

  template class BoundaryStress<2>;
  template class BoundaryStress<3>;
} // namespace Stroma::Sph
