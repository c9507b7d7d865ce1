// Values of SolidMethod at any place, for comparisons.

#include <stroma/fem/solid_method.h>
#include <stroma/output/collective.h>
#include <stroma/solid/stress_measures.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/grid_tools_cache.h>
#include <deal.II/matrix_free/fe_point_evaluation.h>

#include <map>

namespace Stroma::Fem
{
  namespace
  {
    /// Everything that can be asked for at a place.
    template <int dim>
    struct State
    {
      dealii::Tensor<1, dim>        u, v;
      dealii::Tensor<2, dim>        H;
      dealii::SymmetricTensor<2, 3> stress;
    };

    template <int dim>
    unsigned int
    fill(const std::string &field, const State<dim> &s, double *value)
    {
      if (field == "displacement_m" || field == "velocity_m_per_s")
        {
          const auto &vector = field == "displacement_m" ? s.u : s.v;
          std::copy(vector.begin_raw(), vector.end_raw(), value);
          return dim;
        }
      if (field == "displacement_gradient")
        {
          s.H.unroll(value, value + dim * dim);
          return dim * dim;
        }
      if (field == "cauchy_stress_Pa")
        {
          for (unsigned int i = 0; i < 6; ++i)
            value[i] = s.stress.access_raw_entry(i);
          return 6;
        }
      *value = field == "von_mises_Pa" ? Solid::von_mises(s.stress) : Solid::pressure(s.stress);
      return 1;
    }

    unsigned int
    width_of(const std::vector<SampledField> &known, const std::vector<std::string> &fields)
    {
      unsigned int width = 0;
      for (const auto &name : fields)
        for (const auto &field : known)
          if (field.name == name)
            width += field.components;
      return width;
    }

    /// Weights of a tensor product of Gauss points in the polynomial through them, at a unit place.
    template <int dim>
    std::vector<double>
    interpolation(const dealii::Quadrature<1> &gauss, const dealii::Point<dim> &unit)
    {
      const unsigned int               n = gauss.size();
      std::vector<std::vector<double>> line(dim, std::vector<double>(n, 1.));
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            if (j != i)
              line[d][i] *= (unit[d] - gauss.point(j)[0]) / (gauss.point(i)[0] - gauss.point(j)[0]);
      std::vector<double> weights(std::pow(n, dim));
      for (unsigned int q = 0; q < weights.size(); ++q)
        {
          weights[q] = 1.;
          for (unsigned int d = 0, rest = q; d < dim; ++d, rest /= n)
            weights[q] *= line[d][rest % n];
        }
      return weights;
    }

    template <int dim>
    dealii::Point<dim>
    point(const std::array<double, 3> &X)
    {
      dealii::Point<dim> p;
      for (unsigned int d = 0; d < dim; ++d)
        p[d] = X[d];
      return p;
    }

    /// The places of @p X in owned cells of this rank: by cell, (place in X, unit coordinates).
    template <int dim>
    auto
    places_by_cell(const Mesh<dim> &mesh, const std::vector<std::array<double, 3>> &X)
    {
      using Cell = typename dealii::Triangulation<dim>::active_cell_iterator;
      std::map<Cell, std::vector<std::pair<std::size_t, dealii::Point<dim>>>> places;
      std::vector<dealii::Point<dim>>                                         points;
      for (const auto &x : X)
        points.push_back(point<dim>(x));
      const dealii::GridTools::Cache<dim> cache(mesh.triangulation, mesh.mapping());
      const auto  found   = dealii::GridTools::compute_point_locations_try_all(cache, points);
      const auto &cells   = std::get<0>(found);
      const auto &units   = std::get<1>(found);
      const auto &indices = std::get<2>(found);
      for (std::size_t c = 0; c < cells.size(); ++c)
        for (std::size_t i = 0; i < units[c].size(); ++i)
          if (cells[c]->is_locally_owned())
            places[cells[c]].emplace_back(indices[c][i], units[c][i]);
          else if (!cells[c]->is_artificial())
            // On the boundary between two ranks either may find the other's cell: take what this rank has there.
            for (const auto &[cell, unit] :
                 dealii::GridTools::find_all_active_cells_around_point(mesh.mapping(), mesh.triangulation,
                                                                       points[indices[c][i]], 1e-8, {cells[c], units[c][i]}))
              if (cell->is_active() && cell->is_locally_owned())
                places[cell].emplace_back(indices[c][i], unit);
      return places;
    }
  } // namespace

  template <int dim>
  std::vector<SampledField>
  SolidMethod<dim>::sampled_fields() const
  {
    std::vector<SampledField> fields = {{"displacement_m", dim},
                                        {"displacement_gradient", dim * dim},
                                        {"von_mises_Pa", 1},
                                        {"pressure_Pa", 1},
                                        {"cauchy_stress_Pa", 6}};
    if (settings.order != Solvers::Order::statics)
      fields.push_back({"velocity_m_per_s", dim});
    return fields;
  }

  template <int dim>
  void
  SolidMethod<dim>::sample(const std::vector<std::string> &fields, Samples &samples)
  {
    const unsigned int  width = width_of(sampled_fields(), fields);
    std::vector<double> values(samples.X.size() * width, 0.), count(samples.X.size(), 0.);
    const auto          places = places_by_cell(*mesh, samples.X);
    const dealii::QGauss<1>            gauss(settings.n_quadrature_points());
    dealii::FEPointEvaluation<dim, dim> evaluation(mesh->mapping(), unknowns->fe, dealii::update_values | dealii::update_gradients);
    std::vector<dealii::Point<dim>>     units;
    std::vector<double>                 one(width);
    system->for_each_cell(motion.u, motion.v, [&](const auto &cell, const SolidCell<dim> &integrals, const auto &m) {
      const auto here = places.find(cell);
      if (here == places.end())
        return;
      units.clear();
      for (const auto &place : here->second)
        units.push_back(place.second);
      std::vector<State<dim>> states(units.size());
      evaluation.reinit(cell, units);
      evaluation.evaluate(dealii::make_array_view(m.u), dealii::EvaluationFlags::values | dealii::EvaluationFlags::gradients);
      for (unsigned int i = 0; i < units.size(); ++i)
        {
          states[i].u = evaluation.get_value(i);
          states[i].H = evaluation.get_gradient(i);
          const auto weights = interpolation<dim>(gauss, units[i]);
          for (unsigned int q = 0; q < weights.size(); ++q)
            states[i].stress += weights[q] * integrals.cauchy_stress(q);
        }
      if (!m.v.empty())
        {
          evaluation.evaluate(dealii::make_array_view(m.v), dealii::EvaluationFlags::values);
          for (unsigned int i = 0; i < units.size(); ++i)
            states[i].v = evaluation.get_value(i);
        }
      for (unsigned int i = 0; i < units.size(); ++i)
        {
          double *next = one.data();
          for (const auto &field : fields)
            next += fill(field, states[i], next);
          const std::size_t place = here->second[i].first;
          count[place] += 1.;
          for (unsigned int k = 0; k < width; ++k)
            values[place * width + k] += one[k];
        }
    });
    dealii::Utilities::MPI::sum(count, scene.comm, count);
    dealii::Utilities::MPI::sum(values, scene.comm, values);
    samples.found.assign(samples.X.size(), false);
    for (std::size_t i = 0; i < count.size(); ++i)
      if (count[i] > 0)
        {
          samples.found[i] = true;
          for (unsigned int k = 0; k < width; ++k)
            values[i * width + k] /= count[i];
        }
    samples.values = std::move(values);
  }

  template <int dim>
  Samples
  SolidMethod<dim>::own_samples(const std::vector<std::string> &fields)
  {
    Samples             mine;
    std::vector<double> one(width_of(sampled_fields(), fields));
    system->for_each_cell(motion.u, motion.v, [&](const auto &, const SolidCell<dim> &integrals, const auto &m) {
      const auto &shapes = integrals.values();
      for (unsigned int q = 0; q < integrals.n_points(); ++q)
        {
          State<dim> state;
          for (unsigned int a = 0; a < m.u.size(); ++a)
            {
              const unsigned int c = unknowns->fe.system_to_component_index(a).first;
              state.u[c] += m.u[a] * shapes.shape_value(a, q);
              state.H[c] += m.u[a] * shapes.shape_grad(a, q);
              if (!m.v.empty())
                state.v[c] += m.v[a] * shapes.shape_value(a, q);
            }
          state.stress = integrals.cauchy_stress(q);
          std::array<double, 3> X{{0, 0, 0}};
          for (unsigned int d = 0; d < dim; ++d)
            X[d] = integrals.place(q)[d];
          mine.X.push_back(X);
          mine.weight.push_back(integrals.volume(q));
          mine.material.push_back(integrals.material(q));
          double *next = one.data();
          for (const auto &field : fields)
            next += fill(field, state, next);
          mine.values.insert(mine.values.end(), one.begin(), one.end());
        }
    });
    Samples all;
    all.X        = Output::gather_all(mine.X, scene.comm);
    all.weight   = Output::gather_all(mine.weight, scene.comm);
    all.material = Output::gather_all(mine.material, scene.comm);
    all.values   = Output::gather_all(mine.values, scene.comm);
    return all;
  }

  template class SolidMethod<2>;
  template class SolidMethod<3>;
} // namespace Stroma::Fem
