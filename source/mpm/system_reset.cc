// What a reset of the grid asks of the points, and does to them.

#include <stroma/mpm/system.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Mpm
{
  template <int dim>
  bool
  System<dim>::stays_on_grid(const Vector &u)
  {
    int        outside = 0;
    const auto lower = grid.box().lower, upper = grid.box().upper();
    for_each_cell(u, [&](const ActiveCell<dim> &, const GatheredPoints<dim> &p) {
      for (unsigned int q = 0; q < p.size; ++q)
        {
          const auto x = p.location[q] + p.displacement(q);
          for (unsigned int d = 0; d < dim; ++d)
            if (!(x[d] >= lower[d] && x[d] <= upper[d]))
              outside = 1;
        }
      return StepStatus::ok;
    });
    return dealii::Utilities::MPI::max(outside, comm) == 0;
  }

  template <int dim>
  double
  System<dim>::distortion(const Vector &u)
  {
    double largest = 0;
    for_each_cell(u, [&](const ActiveCell<dim> &, const GatheredPoints<dim> &p) {
      for (unsigned int q = 0; q < p.size; ++q)
        largest = std::max(largest, (.5 * (transpose(p.F_D[q]) * p.F_D[q] -
                                           dealii::Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>())))
                                      .norm());
      return StepStatus::ok;
    });
    return dealii::Utilities::MPI::max(largest, comm);
  }

  template <int dim>
  void
  System<dim>::rebase_points(const Vector &u, const bool move_locations)
  {
    for_each_cell(u, [&](const ActiveCell<dim> &active, const GatheredPoints<dim> &p) {
      for (unsigned int q = 0; q < p.size; ++q)
        {
          const auto moved = p.displacement(q);
          for (unsigned int i = 0; i < dim; ++i)
            {
              p.values[q][points.displacement.first + i] += moved[i];
              for (unsigned int k = 0; k < dim; ++k)
                p.values[q][points.deformation.first + i * dim + k] = p.F[q][i][k];
              for (unsigned int k = 0; k < dim && p.is_viscous; ++k)
                p.values[q][points.velocity_gradient.first + i * dim + k] = p.L[q][i][k];
            }
        }
      if (move_locations)
        for (auto &point : points.handler.particles_in_cell(active.cell))
          point.set_location(point.get_location() + p.displacement(point.get_reference_location()));
      return StepStatus::ok;
    });
  }

  template <int dim>
  double
  System<dim>::emptiest_inner_cell() const
  {
    double cell_volume = dim == 2 ? scene.thickness : 1.;
    for (unsigned int d = 0; d < dim; ++d)
      cell_volume *= grid.box().cell_size[d];
    double least = 1;
    for (const auto &active : cells)
      {
        bool is_inner = true;
        for (const unsigned int f : active.cell->face_indices())
          is_inner &= !active.cell->at_boundary(f) && grid.is_active(active.cell->neighbor(f));
        double volume = 0;
        if (is_inner)
          for (const auto &point : points.handler.particles_in_cell(active.cell))
            {
              const auto numbers = point.get_properties();
              volume += numbers[points.volume.first] * (points.weight.stored() ? numbers[points.weight.first] : 1.) *
                        determinant(points.deformation_of(numbers.data()));
            }
        least = is_inner ? std::min(least, volume / cell_volume) : least;
      }
    return dealii::Utilities::MPI::min(least, comm);
  }

  template <int dim>
  double
  System<dim>::misfit(const Vector &u)
  {
    double                              squares = 0, spread = 0;
    std::vector<dealii::Tensor<1, dim>> X, x;
    std::vector<dealii::Tensor<2, dim>> F;
    for_each_cell(u, [&](const ActiveCell<dim> &, const GatheredPoints<dim> &p) {
      X.resize(p.size);
      x.resize(p.size);
      F.resize(p.size);
      double                 volume = 0.;
      dealii::Tensor<1, dim> X_mean, x_mean, FX_mean;
      dealii::Tensor<2, dim> F_mean;
      for (unsigned int q = 0; q < p.size; ++q)
        {
          const double V = p.initial_volume(q);
          X[q]           = points.initial_place(p.location[q], p.values[q]);
          x[q]           = p.location[q] + p.displacement(q);
          F[q]           = p.F_D[q] * points.deformation_of(p.values[q]);
          volume += V;
          X_mean += V * X[q];
          x_mean += V * x[q];
          F_mean += V * F[q];
        }
      F_mean /= volume;
      for (unsigned int q = 0; q < p.size; ++q)
        {
          X[q] -= X_mean / volume;
          x[q] -= x_mean / volume;
          FX_mean += p.initial_volume(q) / volume * F[q] * X[q];
        }
      for (unsigned int q = 0; q < p.size; ++q)
        {
          squares += p.initial_volume(q) * (x[q] - .5 * ((F[q] + F_mean) * X[q] - FX_mean)).norm_square();
          spread += p.initial_volume(q) * x[q].norm_square();
        }
      return StepStatus::ok;
    });
    squares = dealii::Utilities::MPI::sum(squares, comm);
    spread  = dealii::Utilities::MPI::sum(spread, comm);
    return spread > 0. ? std::sqrt(squares / spread) : 0.;
  }

#define INSTANTIATE(dim)                                                                                               \
  template bool   System<dim>::stays_on_grid(const Vector &);                                                          \
  template double System<dim>::distortion(const Vector &);                                                             \
  template void   System<dim>::rebase_points(const Vector &, bool);                                                    \
  template double System<dim>::misfit(const Vector &);                                                                 \
  template double System<dim>::emptiest_inner_cell() const;
  INSTANTIATE(2)
  INSTANTIATE(3)
#undef INSTANTIATE
} // namespace Stroma::Mpm
