// Values of MpmMethod at places of the undeformed scene.
//
// While the grid has never been reset, its displacement at X is that of the method, exactly, and its gradient too. After
// a reset (and with published forces) the grid remembers nothing: the nearest material point p of the material at X
// then gives u(X) = u_p + (F_p - I) (X - X_p) and F(X) = F_p. Stresses follow from F by the law of the material at X, or, where
// there is viscosity or history, are those of the nearest point.

#include "point_state.h"

#include <stroma/mpm/linear_shape.h>
#include <stroma/mpm/method.h>
#include <stroma/output/collective.h>
#include <stroma/scene/rheology.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <limits>
#include <unordered_map>

namespace Stroma::Mpm
{
  namespace
  {
    constexpr std::uint64_t nobody = std::numeric_limits<std::uint64_t>::max();

    /// The fields that can be sampled: some of those that points are written with, and the gradient.
    template <int dim>
    std::vector<PointField<dim>>
    sample_table()
    {
      auto table = Output::named(point_fields<dim>(), {"displacement", "von_mises", "pressure", "cauchy_stress"});
      table.push_back({"displacement_gradient", "", dim * dim, [](const PointState<dim> &s, double *v) {
                         for (unsigned int i = 0; i < dim; ++i)
                           for (unsigned int k = 0; k < dim; ++k)
                             *v++ = s.F[i][k] - (i == k);
                       }});
      return table;
    }

    /// Number of a cell in the grid's box; places outside get the numbers of no cell that holds points.
    template <int dim>
    std::int64_t
    lattice_number(const GridBox<dim> &box, const std::array<int, dim> &index)
    {
      std::int64_t number = 0;
      for (int d = dim - 1; d >= 0; --d)
        {
          if (index[d] < 0 || index[d] >= static_cast<int>(box.n_cells[d]))
            return -1;
          number = number * box.n_cells[d] + index[d];
        }
      return number;
    }

    template <int dim>
    std::array<int, dim>
    lattice_index(const GridBox<dim> &box, const dealii::Point<dim> &X)
    {
      std::array<int, dim> index;
      for (unsigned int d = 0; d < dim; ++d)
        index[d] = box.cell_index(X[d], d);
      return index;
    }

    /// Whether F alone tells the stress.
    template <int dim>
    bool
    is_elastic(const Scene<dim> &scene)
    {
      return !is_viscous(scene) && n_history(scene) == 0;
    }

    /// Cauchy stress and J of @p state from its F by its material's law; false if the law has no answer there.
    template <int dim>
    bool
    evaluate_law(const Scene<dim> &scene, PointState<dim> &state)
    {
      dealii::Tensor<2, 3>          F;
      dealii::SymmetricTensor<2, 3> tau;
      double                        F33 = 1.;
      F[2][2]                           = 1.;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int k = 0; k < dim; ++k)
          F[i][k] = state.F[i][k];
      if (scene.materials[state.material]->evaluate({{&F, 1}, {}}, {{&tau, 1}, {}, {}, {&F33, 1}, {}}) != StepStatus::ok)
        return false;
      state.J      = determinant(state.F) * (dim == 2 ? F33 : 1.);
      state.cauchy = tau / state.J;
      return true;
    }

    /// This rank's part of the never reset grid.
    template <int dim>
    class GridSampler
    {
    public:
      /// @param projected whether stresses follow from the mean dilatation of the cell
      GridSampler(const BackgroundGrid<dim> &grid, const Points<dim> &points, const Vector &u, const bool projected,
                  const MPI_Comm comm)
        : box(grid.box())
        , points(points)
        , projected(projected)
        , displacement(grid.owned, grid.relevant, comm)
        , inverse_size()
      {
        displacement = u;
        for (unsigned int d = 0; d < dim; ++d)
          inverse_size[d] = 1. / box.cell_size[d];
        for (const auto &cell : grid.dofs.active_cell_iterators())
          if (cell->is_locally_owned() && grid.is_active(cell))
            cells.emplace(lattice_number<dim>(box, lattice_index(box, cell->center())), cell);
      }

      /// The cell of this rank that holds @p X and its rank among the cells that touch X; the lowest one counts.
      std::uint64_t find(const dealii::Point<dim> &X)
      {
        const auto first = lattice_index(box, X);
        for (unsigned int candidate = 0; candidate < (1u << dim); ++candidate)
          {
            auto index  = first;
            bool touches = true;
            for (unsigned int d = 0; d < dim; ++d)
              if (candidate >> d & 1)
                touches &= (X[d] - box.lower[d]) * inverse_size[d] - index[d]-- < 1e-6;
            const auto known = touches ? cells.find(lattice_number<dim>(box, index)) : cells.end();
            if (known != cells.end())
              {
                cell = known->second;
                return candidate;
              }
          }
        return nobody;
      }

      /// State at the place that find() has found.
      PointState<dim> state(const Scene<dim> &scene, const dealii::Point<dim> &X)
      {
        dealii::Point<dim> xi;
        for (unsigned int d = 0; d < dim; ++d)
          xi[d] = (X[d] - cell->vertex(0)[d]) * inverse_size[d];
        const LinearShape<dim> shape(xi, inverse_size);
        dofs.resize(dim << dim);
        cell->get_dof_indices(dofs);
        PointState<dim> state;
        state.X        = X;
        state.V0       = 0.;
        const auto at  = scene.material_at(X);
        state.material = at ? *at : material_of_nearest(X);
        state.F = gradient(shape);
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int a = 0; a < (1u << dim); ++a)
            state.u[i] += shape.value[a] * displacement(dofs[a * dim + i]);
        if (projected)
          state.F *= std::exp((mean_log_J() - std::log(determinant(state.F))) / dim);
        return state;
      }

    private:
      /// F of the present cell's unknowns.
      dealii::Tensor<2, dim> gradient(const LinearShape<dim> &shape) const
      {
        dealii::Tensor<2, dim> F;
        for (unsigned int i = 0; i < dim; ++i)
          {
            F[i][i] = 1.;
            for (unsigned int a = 0; a < (1u << dim); ++a)
              for (unsigned int k = 0; k < dim; ++k)
                F[i][k] += shape.gradient[k][a] * displacement(dofs[a * dim + i]);
          }
        return F;
      }

      /// Mean of ln J over the points of the present cell.
      double mean_log_J() const
      {
        double sum = 0, volume = 0;
        for (const auto &point : points.handler.particles_in_cell(cell))
          {
            const double V = point.get_properties()[points.volume.first];
            sum += V * std::log(determinant(gradient(LinearShape<dim>(point.get_reference_location(), inverse_size))));
            volume += V;
          }
        return sum / volume;
      }

      /// For places in the cell that lie just outside of the bodies.
      unsigned int material_of_nearest(const dealii::Point<dim> &X) const
      {
        std::pair<double, unsigned int> best{std::numeric_limits<double>::max(), 0};
        for (const auto &point : points.handler.particles_in_cell(cell))
          best = std::min(best, {point.get_location().distance(X), points.material_of(point.get_properties().data())});
        return best.second;
      }

      using Cell = typename BackgroundGrid<dim>::CellIterator;
      const GridBox<dim>                          &box;
      const Points<dim>                           &points;
      bool                                         projected;
      Vector                                       displacement;
      dealii::Tensor<1, dim>                       inverse_size;
      std::unordered_map<std::int64_t, Cell>       cells;
      Cell                                         cell;
      std::vector<dealii::types::global_dof_index> dofs;
    };

    /// This rank's material points by the cell that held them at the start, for runs whose grid was reset.
    template <int dim>
    class NearestPoint
    {
    public:
      explicit NearestPoint(const GridBox<dim> &box)
        : box(box)
      {}

      void add(const PointState<dim> &state)
      {
        bins[lattice_number<dim>(box, lattice_index(box, state.X))].push_back(states.size());
        states.push_back(state);
      }

      /// Finds this rank's nearest point of material @p material within a cell's diagonal. Points at equal distances
      /// (up to 1e-6 of it) are told apart by their place, so that the choice does not depend on the number of ranks.
      std::uint64_t find(const dealii::Point<dim> &X, const unsigned int material)
      {
        std::uint64_t best  = nobody;
        const auto    index = lattice_index(box, X);
        for (unsigned int neighbour = 0; neighbour < n_neighbours; ++neighbour)
          {
            auto other = index;
            for (unsigned int d = 0, n = neighbour; d < dim; ++d, n /= 3)
              other[d] += static_cast<int>(n % 3) - 1;
            const auto bin = bins.find(lattice_number<dim>(box, other));
            if (bin == bins.end())
              continue;
            for (const std::size_t p : bin->second)
              if (states[p].material == material && X.distance(states[p].X) < box.cell_size.norm())
                {
                  const std::uint64_t key = name(X.distance(states[p].X), states[p].X);
                  if (key < best)
                    {
                      best  = key;
                      found = p;
                    }
                }
          }
        return best;
      }

      PointState<dim> state(const dealii::Point<dim> &X) const
      {
        PointState<dim>              state = states[found];
        const dealii::Tensor<1, dim> apart = X - state.X;
        state.u += state.F * apart - apart;
        state.X = X;
        return state;
      }

    private:
      static constexpr unsigned int n_neighbours = dim == 2 ? 9 : 27;

      /// 22 bits of distance, then 42 bits of place.
      std::uint64_t name(const double distance, const dealii::Point<dim> &X) const
      {
        constexpr unsigned int bits = 42 / dim;
        std::uint64_t          name = std::llround(1e6 * distance / box.cell_size.norm());
        for (unsigned int d = 0; d < dim; ++d)
          name = name << bits | static_cast<std::uint64_t>((X[d] - box.lower[d]) / (box.upper()[d] - box.lower[d]) *
                                                           ((1u << bits) - 1));
        return name;
      }

      const GridBox<dim>                                        &box;
      std::vector<PointState<dim>>                               states;
      std::unordered_map<std::int64_t, std::vector<std::size_t>> bins;
      std::size_t                                                found = 0;
    };

    template <int dim>
    dealii::Point<dim>
    point_of(const std::array<double, 3> &X)
    {
      dealii::Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
        point[d] = X[d];
      return point;
    }

    /// Fills values and found of @p samples. @p find(X) how well this rank knows the place, the lowest of all ranks wins
    /// (nobody: not at all); @p state(X) the state at the place found last.
    template <int dim, typename Find, typename State>
    void
    take_samples(const Scene<dim> &scene, const std::vector<PointField<dim>> &fields, Samples &samples, const Find &find,
                 const State &state)
    {
      const std::size_t          n = samples.X.size(), width = n_components(fields);
      std::vector<std::uint64_t> mine(n), best(n);
      for (std::size_t i = 0; i < n; ++i)
        mine[i] = find(point_of<dim>(samples.X[i]));
      MPI_Allreduce(mine.data(), best.data(), n, MPI_UINT64_T, MPI_MIN, scene.comm);
      samples.values.assign(n * width, 0.);
      std::vector<unsigned char> found(n, 0);
      for (std::size_t i = 0; i < n; ++i)
        if (best[i] != nobody && mine[i] == best[i])
          {
            const auto X = point_of<dim>(samples.X[i]);
            find(X);
            auto here = state(X);
            found[i]  = !is_elastic(scene) || evaluate_law(scene, here);
            if (found[i])
              fill(fields, here, samples.values.data() + i * width);
          }
      MPI_Allreduce(MPI_IN_PLACE, samples.values.data(), n * width, MPI_DOUBLE, MPI_SUM, scene.comm);
      MPI_Allreduce(MPI_IN_PLACE, found.data(), n, MPI_UNSIGNED_CHAR, MPI_MAX, scene.comm);
      samples.found.assign(found.begin(), found.end());
    }
  } // namespace

  template <int dim>
  std::vector<SampledField>
  MpmMethod<dim>::sampled_fields() const
  {
    std::vector<SampledField> fields;
    for (const auto &field : sample_table<dim>())
      fields.push_back({field.full_name(), field.components});
    return fields;
  }

  template <int dim>
  void
  MpmMethod<dim>::sample(const std::vector<std::string> &names, Samples &samples)
  {
    const auto fields = Output::with_full_names(sample_table<dim>(), names);
    if (n_resets == 0 && settings.internal_force == InternalForce::consistent && is_elastic(scene))
      {
        GridSampler<dim> grid_sampler(*grid, *points, u, settings.projected, scene.comm);
        take_samples<dim>(scene, fields, samples, [&](const auto &X) { return grid_sampler.find(X); },
                          [&](const auto &X) { return grid_sampler.state(scene, X); });
        return;
      }
    NearestPoint<dim> nearest(grid->box());
    for_each_point(*system, *points, u,
                   [&](const PointState<dim> &state, const dealii::Point<dim> &, const auto &) { nearest.add(state); });
    take_samples<dim>(scene, fields, samples,
                      [&](const auto &X) {
                        const auto material = scene.material_at(X);
                        return material ? nearest.find(X, *material) : nobody;
                      },
                      [&](const auto &X) { return nearest.state(X); });
  }

  template <int dim>
  Samples
  MpmMethod<dim>::own_samples(const std::vector<std::string> &names)
  {
    const auto         fields = Output::with_full_names(sample_table<dim>(), names);
    const unsigned int width  = n_components(fields);
    Samples            mine;
    for_each_point(*system, *points, u,
                   [&](const PointState<dim> &state, const dealii::Point<dim> &, const auto &) {
                     std::array<double, 3> X{{0., 0., 0.}};
                     std::copy(state.X.begin_raw(), state.X.end_raw(), X.begin());
                     mine.X.push_back(X);
                     mine.weight.push_back(state.V0);
                     mine.material.push_back(state.material);
                     mine.values.resize(mine.values.size() + width);
                     fill(fields, state, mine.values.data() + mine.values.size() - width);
                   });
    mine.X        = Output::gather_all(mine.X, scene.comm);
    mine.weight   = Output::gather_all(mine.weight, scene.comm);
    mine.material = Output::gather_all(mine.material, scene.comm);
    mine.values   = Output::gather_all(mine.values, scene.comm);
    return mine;
  }

  template class MpmMethod<2>;
  template class MpmMethod<3>;
} // namespace Stroma::Mpm
