#include <stroma/sph/lattice_sum.h>
#include <stroma/sph/packing.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  using dealii::Tensor;

  template <int dim>
  Packing<dim>::Packing(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours,
                        const std::vector<Constitution> &constitutions, const Settings &settings)
    : pairs(pairs)
    , neighbours(neighbours)
    , constitutions(constitutions)
    , settings(settings)
  {
    with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) {
      s_0 = lattice_sum<dim>(kernel.support(), settings.arrangement.spacing, settings.arrangement.name,
                             [&](const double r) { return kernel.W(r); });
    });
  }

  template <int dim>
  void
  Packing<dim>::update(Particles<dim> &particles)
  {
    with_kernel<dim>(settings.kernel, settings.h(), [&](const auto &kernel) { add_rows(particles, kernel); });
    q.assign(pairs.n_points(), 0.);
    q_of_increment.assign(pairs.n_points(), 0.);
    set_pressures(particles);
  }

  template <int dim>
  template <typename KernelType>
  void
  Packing<dim>::add_rows(Particles<dim> &particles, const KernelType &kernel)
  {
    const unsigned int n = pairs.n_rows();
    volume.resize(n);
    K.resize(n);
    kappa.resize(n);
    g.resize(pairs.n_pairs());
    for (unsigned int i = 0; i < n; ++i)
    {
      volume[i]  = particles.volume(i);
      K[i]       = constitutions[particles.material_of(i)].K;
      double sum = volume[i] * kernel.W(0.);
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      {
        const unsigned int   j        = pairs.particle(p);
        const Tensor<1, dim> r        = particles.x[j] - particles.x[i]; // not the way to a wall, as in pairs
        const double         distance = r.norm(), V = particles.volume(j);
        sum += V * kernel.W(distance);
        g[p] = volume[i] * V * kernel.F(distance) / s_0 * r;
      }
      particles.excess[i] = sum / s_0 - 1.;
    }
  }

  template <int dim>
  void
  Packing<dim>::set_loads(const std::vector<Tensor<1, dim>> &forces)
  {
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      kappa[i] = std::min(strength * settings.arrangement.spacing * forces[i].norm() / volume[i], largest_kappa * K[i]);
    set_pressures();
  }

  template <int dim>
  void
  Packing<dim>::set_pressures(const Particles<dim> &particles)
  {
    crowding.resize(pairs.n_rows());
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      crowding[i] = std::max(particles.excess[i], 0.);
    set_pressures();
  }

  template <int dim>
  void
  Packing<dim>::set_pressures()
  {
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      q[i] = kappa[i] * crowding[i] * crowding[i] / e;
    neighbours.update_ghosts(q);
  }

  template <int dim>
  double
  Packing<dim>::rate(const unsigned int i, const std::vector<Tensor<1, dim>> &v) const
  {
    double sum = 0.;
    for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
      sum += g[p] * (v[pairs.j[p]] - v[i]);
    return -sum / volume[i];
  }

  template <int dim>
  void
  Packing<dim>::move(Particles<dim> &particles, const std::vector<Tensor<1, dim>> &v, const double dt)
  {
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      particles.excess[i] += dt * rate(i, v);
    set_pressures(particles);
  }

  template <int dim>
  void
  Packing<dim>::add_pairs(std::vector<Tensor<1, dim>> &f, const std::vector<double> &pressures) const
  {
    for (unsigned int i = 0; i < neighbours.n_free(); ++i)
    {
      Tensor<1, dim> sum;
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_start[i + 1]; ++p)
        sum += (pressures[i] + pressures[pairs.j[p]]) * g[p];
      f[i] -= sum;
    }
  }

  template <int dim>
  void
  Packing<dim>::add_force(std::vector<Tensor<1, dim>> &f) const
  {
    add_pairs(f, q);
  }

  template <int dim>
  Tensor<1, dim>
  Packing<dim>::pair_force(const unsigned int i, const std::size_t p) const
  {
    return -(q[i] + q[pairs.j[p]]) * g[p];
  }

  template <int dim>
  void
  Packing<dim>::add_stiffness_force(std::vector<Tensor<1, dim>> &f, const std::vector<Tensor<1, dim>> &u,
                                    const double factor) const
  {
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      q_of_increment[i] = factor * 2. * kappa[i] * crowding[i] / e * rate(i, u);
    neighbours.update_ghosts(q_of_increment);
    add_pairs(f, q_of_increment);
  }

  template <int dim>
  double
  Packing<dim>::energy() const
  {
    double energy = 0.;
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
      energy += q[i] * crowding[i] * volume[i] / 3.;
    return energy;
  }

  template <int dim>
  double
  Packing<dim>::mean_excess() const
  {
    std::vector<double> sums(2);
    for (unsigned int i = 0; i < pairs.n_rows(); ++i)
    {
      sums[0] += volume[i] * crowding[i];
      sums[1] += volume[i];
    }
    dealii::Utilities::MPI::sum(sums, neighbours.communicator(), sums);
    return sums[0] / sums[1];
  }

  template class Packing<2>;
  template class Packing<3>;
} // namespace Stroma::Sph
