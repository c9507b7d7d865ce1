#include <stroma/particles/lattice_sum.h>
#include <stroma/sph/packing.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

#include "second_moment.h"

namespace Stroma::Sph
{
  template <int dim>
  Packing<dim>::Packing(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const Settings &settings)
    : pairs(pairs)
    , neighbours(neighbours)
    , settings(settings)
  {
    with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) {
      s_0 = lattice_sum<dim>(kernel.support(), settings.arrangement.spacing, settings.arrangement.name,
                             [&](const double r) { return kernel.W(r); });
    });
  }

  template <int dim>
  void
  Packing<dim>::update(ParticleSet<dim> &particles)
  {
    with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) { add_rows(particles, kernel); });
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      if (particles.excess[i] == not_found)
        particles.excess[i] = excess[i];
    crowding.assign(pairs.n_points(), 0.);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      crowding[i] = std::max(excess[i], 0.);
    neighbours.update_ghosts(crowding);
  }

  template <int dim>
  std::vector<dealii::Tensor<1, dim>>
  Packing<dim>::shifts(const ParticleSet<dim> &particles, const std::vector<dealii::Tensor<1, dim>> &v,
                       const double dt) const
  {
    std::vector<dealii::Tensor<1, dim>> dx(neighbours.n_free());
    for (unsigned int i = 0; i < dx.size(); ++i)
      {
        dealii::Tensor<1, dim> sum;
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
          {
            const unsigned int k = p < pairs.row_fixed[i] ? pairs.j[p] : i; // beyond a wall it is as crowded as here
            sum += (crowding[i] + crowding[k]) * pairs.P[p] * pairs.r[p];
          }
        sum *= shift_strength * settings.h() / particles.volume(i);
        dx[i] = -v[i].norm() * dt / std::max(sum.norm(), 1.) * sum;
      }
    return dx;
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Packing<dim>::gradient(const ParticleSet<dim> &particles, const unsigned int i,
                         const std::vector<double> &field) const
  {
    dealii::Tensor<2, dim> moment;
    dealii::Tensor<1, dim> sum;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
      {
        if (particles.material_of(pairs.j[p]) != particles.material_of(i))
          continue;
        moment += pairs.P[p] * outer_product(pairs.r[p], pairs.r[p]);
        sum += pairs.P[p] * (field[pairs.j[p]] - field[i]) * pairs.r[p];
      }
    return tells_gradient(moment) ? invert(moment) * sum : dealii::Tensor<1, dim>();
  }

  template <int dim>
  template <typename KernelType>
  void
  Packing<dim>::add_rows(const ParticleSet<dim> &particles, const KernelType &kernel)
  {
    excess.resize(pairs.n_rows());
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        double sum = particles.volume(i) * kernel.W(0.);
        for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
          sum += particles.volume(pairs.j[p]) * kernel.W(pairs.r[p].norm());
        for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
          sum += pairs.wall(p).missing;
        excess[i] = sum / s_0 - 1.;
      }
  }

  template <int dim>
  double
  Packing<dim>::mean_excess(const ParticleSet<dim> &particles) const
  {
    std::vector<double> sums(2);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      {
        sums[0] += particles.volume(i) * (std::max(excess[i], 0.) - std::max(particles.excess[i], 0.));
        sums[1] += particles.volume(i);
      }
    dealii::Utilities::MPI::sum(sums, neighbours.communicator(), sums);
    return sums[0] / sums[1];
  }

  template class Packing<2>;
  template class Packing<3>;
} // namespace Stroma::Sph
