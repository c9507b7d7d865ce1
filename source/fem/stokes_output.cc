// Fields and results of StokesMethod.

#include <stroma/base/text.h>
#include <stroma/fem/stokes_method.h>
#include <stroma/output/grid_writer.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>

namespace Stroma::Fem
{
  template <int dim>
  void
  StokesMethod<dim>::collect_scalars(const Vector &unbalanced)
  {
    const auto scope = timers.scope("scalars");
    committed_scalars.clear();
    collect_reactions(unbalanced);
    std::array<double, dim + 1> sums{}; // volume integrals of v, dissipation
    system->for_each_point(flow, system->quadrature(), [&](const auto &, const Point &q) {
      for (unsigned int d = 0; d < dim; ++d)
        sums[d] += q.v[d] * q.JxW;
      sums[dim] += scalar_product(system->viscosity(q.material).stress(q.G), q.G) * q.JxW;
    });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), dim + 1, MPI_DOUBLE, MPI_SUM, scene.comm);
    const auto box = scene.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      committed_scalars.emplace_back(std::string("flow_rate_") + "xyz"[d] + "_m3_per_s", sums[d] / box.side_length(d));
    committed_scalars.emplace_back("max_speed_m_per_s", max_speed());
    committed_scalars.emplace_back("dissipation_W", sums[dim]);
  }

  /// Forces by which supports and rigid bodies hold the fluid; those at a shared node count for the first in the file.
  template <int dim>
  void
  StokesMethod<dim>::collect_reactions(const Vector &unbalanced)
  {
    std::vector<double> reactions(space->holders.size() * dim);
    for (const auto &unknown : space->held)
      reactions[unknown.holder * dim + unknown.component] -= unbalanced[unknown.dof];
    dealii::Utilities::MPI::sum(reactions, scene.comm, reactions);
    for (unsigned int h = 0; h < space->holders.size(); ++h)
    {
      const auto &holder = space->holders[h];
      for (unsigned int c = 0; c < dim; ++c)
        if (holder.body >= 0 || scene.supports[holder.support].holds(c))
          committed_scalars.emplace_back("reaction_" + holder.name + "_" + "xyz"[c] + "_N", reactions[h * dim + c]);
    }
  }

  /// On a lattice of twice as many points as there are nodes along each axis.
  template <int dim>
  double
  StokesMethod<dim>::max_speed() const
  {
    double     largest = 0.;
    const auto points  = dealii::QIterated<dim>(dealii::QTrapezoid<1>(), 2 * settings.degree);
    system->for_each_point(flow, points, [&](const auto &, const Point &q) { largest = std::max(largest, q.v.norm()); });
    return dealii::Utilities::MPI::max(largest, scene.comm);
  }

  template <int dim>
  std::vector<std::pair<std::string, std::string>>
  StokesMethod<dim>::write_fields(const FieldRequest &request)
  {
    if (!request.grid_fields)
      return {};
    const auto             scope   = timers.scope("field files");
    const unsigned int     n_cells = mesh->triangulation.n_active_cells();
    dealii::Vector<double> von_mises(n_cells), material(n_cells), volume(n_cells);
    system->for_each_point(flow, system->quadrature(), [&](const auto &cell, const Point &q) {
      const unsigned int c = cell->active_cell_index();
      volume[c] += q.JxW;
      von_mises[c] += system->viscosity(q.material).von_mises(q.G) * q.JxW;
      material[c] = cell->material_id();
    });
    for (unsigned int c = 0; c < n_cells; ++c)
      if (volume[c] > 0.)
        von_mises[c] /= volume[c];
    Vector v(space->owned_velocity, space->relevant_velocity, scene.comm);
    Vector p(space->owned_pressure, space->relevant_pressure, scene.comm);
    v = flow.v;
    p = flow.p;
    return { { "grid", Output::write_grid<dim>(request.folder, "grid", request.counter, space->velocity_dofs,
                                               { { "velocity_m_per_s", &v } },
                                               { { "von_mises_Pa", &von_mises }, { "material", &material } },
                                               { { "pressure_Pa", &p, &space->pressure_dofs } }) } };
  }

  template <int dim>
  void
  StokesMethod<dim>::describe(Output::Summary &summary)
  {
    summary.method    = "fem";
    summary.dimension = dim;
    summary.n_cells   = mesh->triangulation.n_global_active_cells();
    summary.n_dofs    = space->velocity_dofs.n_dofs() + space->pressure_dofs.n_dofs();

    const auto list = [&](const bool used, const std::string &part) {
      (used ? summary.used : summary.left_out).push_back(part);
    };
    list(true, "Taylor-Hood elements of degrees " + std::to_string(settings.degree) + " and "
                 + std::to_string(settings.degree - 1));
    list(system->has_inertia(), "inertia");
    list(system->is_compressible(), "compressibility");
    list(mesh->triangulation.has_hanging_nodes(), "hanging nodes");
    list(free_level, "mean pressure set to zero");

    for (const auto &[name, value] : committed_scalars)
      summary.results[name] = value;
    error_results(summary);
  }

  template <int dim>
  void
  StokesMethod<dim>::error_results(Output::Summary &summary) const
  {
    const bool of_velocity = scene.exact_velocity.given(), of_pressure = scene.exact_pressure.given();
    if (!of_velocity && !of_pressure)
      return;
    enum
    {
      v_error,
      v_size,
      G_error,
      G_size,
      p_error,
      p_error_squared,
      p_exact,
      p_exact_squared,
      volume,
      n_sums
    };
    std::array<double, n_sums> sums{};
    const double               step = 1e-5 * scene.bounding_box().side_length(0); // for the exact gradient
    system->for_each_point(flow, dealii::QGauss<dim>(settings.degree + 2), [&](const auto &, const Point &q) {
      sums[volume] += q.JxW;
      if (of_velocity)
      {
        const auto exact = scene.exact_velocity.value(q.X, time);
        sums[v_error] += (q.v - exact).norm_square() * q.JxW;
        sums[v_size] += exact.norm_square() * q.JxW;
        for (unsigned int k = 0; k < dim; ++k)
        {
          const auto d     = dealii::Point<dim>::unit_vector(k) * step;
          const auto slope = (scene.exact_velocity.value(q.X + d, time)
                              - scene.exact_velocity.value(dealii::Point<dim>(q.X - d), time))
                             / (2. * step);
          for (unsigned int i = 0; i < dim; ++i)
            sums[G_error] += std::pow(q.G[i][k] - slope[i], 2) * q.JxW;
          sums[G_size] += slope.norm_square() * q.JxW;
        }
      }
      if (of_pressure)
      {
        const double exact = scene.exact_pressure.value(q.X, time)[0];
        sums[p_error] += (q.p - exact) * q.JxW;
        sums[p_error_squared] += std::pow(q.p - exact, 2) * q.JxW;
        sums[p_exact] += exact * q.JxW;
        sums[p_exact_squared] += exact * exact * q.JxW;
      }
    });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), n_sums, MPI_DOUBLE, MPI_SUM, scene.comm);
    if (of_velocity)
    {
      summary.results["velocity_error_L2_relative"] = std::sqrt(sums[v_error] / sums[v_size]);
      summary.results["velocity_error_H1_relative"] = std::sqrt(sums[G_error] / sums[G_size]);
    }
    if (of_pressure)
    {
      const double mean_error = free_level ? sums[p_error] / sums[volume] : 0.;
      const double mean_exact = free_level ? sums[p_exact] / sums[volume] : 0.;
      summary.results["pressure_error_L2_relative"]
        = std::sqrt((sums[p_error_squared] - mean_error * mean_error * sums[volume])
                    / (sums[p_exact_squared] - mean_exact * mean_exact * sums[volume]));
    }
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
