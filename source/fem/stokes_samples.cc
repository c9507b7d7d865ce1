// Values of StokesMethod at places.

#include <stroma/fem/stokes_method.h>

#include <deal.II/base/mpi.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/grid_tools_cache.h>

#include <algorithm>

namespace Stroma::Fem
{
  template <int dim>
  std::vector<SampledField>
  StokesMethod<dim>::sampled_fields() const
  {
    return { { "velocity_m_per_s", dim },
             { "velocity_gradient_per_s", dim * dim },
             { "pressure_Pa", 1 },
             { "von_mises_Pa", 1 } };
  }

  template <int dim>
  void
  StokesMethod<dim>::append(const std::vector<std::string> &fields, const Point &q, std::vector<double> &values) const
  {
    for (const auto &field : fields)
      if (field == "velocity_m_per_s")
        values.insert(values.end(), q.v.begin_raw(), q.v.end_raw());
      else if (field == "velocity_gradient_per_s")
        for (unsigned int i = 0; i < dim; ++i)
          values.insert(values.end(), q.G[i].begin_raw(), q.G[i].end_raw());
      else if (field == "pressure_Pa")
        values.push_back(q.p);
      else
      {
        AssertThrow(field == "von_mises_Pa", dealii::ExcMessage("Stokes flow has no field " + field));
        values.push_back(system->viscosity(q.material).von_mises(q.G));
      }
  }

  template <int dim>
  void
  StokesMethod<dim>::sample(const std::vector<std::string> &fields, Samples &samples)
  {
    std::vector<dealii::Point<dim>> X(samples.X.size());
    for (unsigned int i = 0; i < X.size(); ++i)
      for (unsigned int d = 0; d < dim; ++d)
        X[i][d] = samples.X[i][d];
    const dealii::GridTools::Cache<dim> cache(mesh->triangulation, mesh->mapping());
    const auto  located = dealii::GridTools::compute_point_locations_try_all(cache, X);
    const auto &cells   = std::get<0>(located);

    // Where several ranks know the cell, the first one answers.
    const unsigned int                                        nobody = dealii::numbers::invalid_unsigned_int;
    const unsigned int                                        me = dealii::Utilities::MPI::this_mpi_process(scene.comm);
    std::vector<unsigned int>                                 known(X.size(), nobody), first(X.size());
    for (unsigned int c = 0; c < cells.size(); ++c)
      if (!cells[c]->is_artificial())
        for (const unsigned int i : std::get<2>(located)[c])
          known[i] = me;
    dealii::Utilities::MPI::min(known, scene.comm, first);

    unsigned int n = 0;
    for (const auto &field : sampled_fields())
      n += std::count(fields.begin(), fields.end(), field.name) * field.components;
    samples.values.assign(n * X.size(), 0.);
    const StokesFlow   ghosted = system->with_ghosts(flow);
    std::vector<Point> points;
    for (unsigned int c = 0; c < cells.size(); ++c)
    {
      if (cells[c]->is_artificial())
        continue;
      StokesCell<dim> values(*space, dealii::Quadrature<dim>(std::get<1>(located)[c]));
      system->evaluate(points, ghosted, values, cells[c]);
      for (unsigned int k = 0; k < points.size(); ++k)
      {
        const unsigned int  i = std::get<2>(located)[c][k];
        std::vector<double> all;
        append(fields, points[k], all);
        if (first[i] == me)
          std::copy(all.begin(), all.end(), samples.values.begin() + n * i);
      }
    }
    dealii::Utilities::MPI::sum(samples.values, scene.comm, samples.values);
    samples.found.resize(X.size());
    for (unsigned int i = 0; i < X.size(); ++i)
      samples.found[i] = first[i] != nobody;
  }

  template <int dim>
  Samples
  StokesMethod<dim>::own_samples(const std::vector<std::string> &fields)
  {
    Samples mine, all;
    system->for_each_point(flow, system->quadrature(), [&](const auto &, const Point &q) {
      mine.X.push_back({});
      std::copy(q.X.begin_raw(), q.X.end_raw(), mine.X.back().begin());
      mine.weight.push_back(q.JxW);
      mine.material.push_back(q.material);
      append(fields, q, mine.values);
    });
    const auto gather = [this](const auto &part, auto &whole) {
      for (const auto &p : dealii::Utilities::MPI::all_gather(scene.comm, part))
        whole.insert(whole.end(), p.begin(), p.end());
    };
    gather(mine.X, all.X);
    gather(mine.weight, all.weight);
    gather(mine.material, all.material);
    gather(mine.values, all.values);
    return all;
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
