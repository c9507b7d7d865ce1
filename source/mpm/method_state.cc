// The committed state of MpmMethod, to look at.
//
// While the grid has never been reset, its displacement at X is that of the method, exactly, and its gradient too. After
// a reset (and with published forces) the grid remembers nothing: the nearest material point p of the material at X
// then gives u(X) = u_p + (F_p - I) (X - X_p) and F(X) = F_p. Stresses follow from F by the law of the material at X, or, where
// there is viscosity or history, are those of the nearest point.

#include <stroma/mpm/method.h>
#include <stroma/output/remote_places.h>
#include <stroma/scene/rheology.h>
#include <stroma/solid/stress_measures.h>

#include <cmath>
#include <optional>
#include <unordered_map>

namespace Stroma::Mpm
{
  namespace
  {
    using Output::Extent;
    using Output::knows_not;
    using Output::PointState;
    using Output::Rating;

    /// What is known of a place in the material.
    template <int dim>
    struct LocalState
    {
      dealii::Point<dim>     X; ///< undeformed [m]
      dealii::Tensor<1, dim> u; ///< since the start [m]
      dealii::Tensor<2, dim> F;
      unsigned int           material = 0;
      // Of points; elsewhere they follow from F where it alone tells them.
      dealii::SymmetricTensor<2, 3> cauchy; ///< [Pa]
      double                        J   = 1.;
      double                        F33 = 1.; ///< of plane scenes
    };

    /// Sets in @p state what is known of the place.
    template <int dim>
    void
    copy(const LocalState<dim> &local, PointState &state)
    {
      for (unsigned int i = 0; i < dim; ++i)
        {
          state.X[i] = local.X[i];
          state.u[i] = local.u[i];
          for (unsigned int k = 0; k < dim; ++k)
            state.u_gradient[i][k] = local.F[i][k] - (i == k);
        }
      state.J         = local.J;
      state.stretch_z = local.F33;
      state.cauchy    = local.cauchy;
      state.pressure  = Solid::pressure(state.cauchy);
      state.material  = local.material;
    }

    template <int dim>
    PointState
    point_state(const LocalState<dim> &local)
    {
      PointState state;
      copy(local, state);
      return state;
    }

    /// Whether F alone tells the stress.
    template <int dim>
    bool
    is_elastic(const Scene<dim> &scene)
    {
      return !is_viscous(scene) && n_history(scene) == 0;
    }

    /// Stress and J follow from F by the material's law; nothing if the law has no answer there.
    template <int dim>
    std::optional<PointState>
    evaluate_law(const Scene<dim> &scene, LocalState<dim> local)
    {
      dealii::Tensor<2, 3>          F = Output::in_space<dim>(local.F);
      dealii::SymmetricTensor<2, 3> tau;
      double                        F33 = 1.;
      if (dim == 2)
        F[2][2] = 1.;
      if (scene.materials[local.material]->evaluate({{&F, 1}, {}}, {{&tau, 1}, {}, {}, {&F33, 1}, {}}) !=
          StepStatus::ok)
        return std::nullopt;
      local.F33    = dim == 2 ? F33 : 1.;
      local.J      = determinant(local.F) * local.F33;
      local.cauchy = tau / local.J;
      return point_state<dim>(local);
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

    /// By the number of an active cell and by material, how far the deformation gradient is from that of the nodes.
    template <int dim>
    using Jumps = std::unordered_map<unsigned int, std::vector<dealii::Tensor<2, dim>>>;

    /// This rank's part of the never reset grid.
    template <int dim>
    class GridSampler
    {
    public:
      /// @param projected whether stresses follow from the mean dilatation of the cell
      GridSampler(const Scene<dim> &scene, const BackgroundGrid<dim> &grid, const Points<dim> &points, const Vector &u,
                  const bool projected, Jumps<dim> jumps)
        : scene(scene)
        , grid(grid)
        , box(grid.box())
        , points(points)
        , projected(projected)
        , jumps(std::move(jumps))
        , displacement(grid.nodes.owned, grid.nodes.relevant, scene.comm)
      {
        displacement = u;
        for (const auto &active : grid.active_cells())
          {
            cells.emplace(lattice_number<dim>(box, box.cell_indices(active.cell->center())), &active);
            extent.add(Output::place_of<dim>(active.cell->vertex(0)));
            extent.add(Output::place_of<dim>(active.cell->vertex((1 << dim) - 1)));
          }
      }

      /// The cell of this rank that holds @p X and its rank among the cells that touch X; the lowest one counts.
      Rating
      find(const dealii::Point<dim> &X)
      {
        const auto first = box.cell_indices(X);
        for (unsigned int candidate = 0; candidate < (1u << dim); ++candidate)
          {
            auto index   = first;
            bool touches = true;
            for (unsigned int d = 0; d < dim; ++d)
              if (candidate >> d & 1)
                touches &= (X[d] - box.lower[d]) / box.cell_size[d] - index[d]-- < 1e-6;
            const auto known = touches ? cells.find(lattice_number<dim>(box, index)) : cells.end();
            if (known != cells.end())
              {
                active = known->second;
                return candidate;
              }
          }
        return knows_not;
      }

      /// State at the place that find() has found.
      LocalState<dim>
      state(const dealii::Point<dim> &X)
      {
        dealii::Point<dim> xi;
        for (unsigned int d = 0; d < dim; ++d)
          xi[d] = (X[d] - active->cell->vertex(0)[d]) / box.cell_size[d];
        const auto      shapes = grid.shape->at(active->index, xi);
        LocalState<dim> state;
        state.X        = X;
        const auto at  = scene.material_at(X);
        state.material = at ? *at : material_of_nearest(X);
        state.F        = gradient(shapes);
        if (const auto jump = jumps.find(active->number); jump != jumps.end())
          state.F += jump->second[state.material];
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int a = 0; a < grid.shape->n_nodes(); ++a)
            state.u[i] += shapes.value[a] * nodal(a, i);
        if (projected)
          state.F *= std::exp((mean_log_J() - std::log(determinant(state.F))) / dim);
        return state;
      }

      Extent extent; ///< of this rank's cells

    private:
      /// Displacement of node @p a of the present cell.
      double
      nodal(const unsigned int a, const unsigned int component) const
      {
        return displacement.begin()[active->node[a] + component];
      }

      /// F of the present cell's unknowns.
      dealii::Tensor<2, dim>
      gradient(const typename ShapeFunctions<dim>::AtPlace &shapes) const
      {
        dealii::Tensor<2, dim> F;
        for (unsigned int i = 0; i < dim; ++i)
          {
            F[i][i] = 1.;
            for (unsigned int a = 0; a < grid.shape->n_nodes(); ++a)
              for (unsigned int k = 0; k < dim; ++k)
                F[i][k] += shapes.gradient[k][a] * nodal(a, i);
          }
        return F;
      }

      /// Mean of ln J over the points of the present cell.
      double
      mean_log_J() const
      {
        double sum = 0, volume = 0;
        points.for_points_of(*active, [&](const auto &xi, const auto &, const unsigned int, const double V) {
          sum += V * std::log(determinant(gradient(grid.shape->at(active->index, xi))));
          volume += V;
        });
        return sum / volume;
      }

      /// For places in the cell that lie just outside of the bodies.
      unsigned int
      material_of_nearest(const dealii::Point<dim> &X) const
      {
        std::pair<double, unsigned int> best{std::numeric_limits<double>::max(), 0};
        points.for_points_of(*active, [&](const auto &, const auto &place, const unsigned int m, const double) {
          best = std::min(best, {place.distance(X), m});
        });
        return best.second;
      }

      const Scene<dim>                                         &scene;
      const BackgroundGrid<dim>                                &grid;
      const GridBox<dim>                                       &box;
      const Points<dim>                                        &points;
      bool                                                      projected;
      Jumps<dim>                                                jumps;
      Vector                                                    displacement;
      std::unordered_map<std::int64_t, const ActiveCell<dim> *> cells;
      const ActiveCell<dim>                                    *active = nullptr; ///< found last
    };

    /// This rank's material points by the cell that held them at the start, for runs whose grid was reset.
    template <int dim>
    class NearestPoint
    {
    public:
      explicit NearestPoint(const GridBox<dim> &box)
        : box(box)
      {}

      void
      add(const LocalState<dim> &state)
      {
        bins[lattice_number<dim>(box, box.cell_indices(state.X))].push_back(states.size());
        states.push_back(state);
        extent.add(Output::place_of<dim>(state.X));
      }

      /// Finds this rank's nearest point of material @p material within a cell's diagonal. Points at equal distances
      /// (up to 1e-6 of it) are told apart by their place, so that the choice does not depend on the number of ranks.
      Rating
      find(const dealii::Point<dim> &X, const unsigned int material)
      {
        std::uint64_t best  = knows_not;
        const auto    index = box.cell_indices(X);
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

      LocalState<dim>
      state(const dealii::Point<dim> &X) const
      {
        LocalState<dim>              state = states[found];
        const dealii::Tensor<1, dim> apart = X - state.X;
        state.u += state.F * apart - apart;
        state.X = X;
        return state;
      }

      Extent extent; ///< of this rank's points

    private:
      static constexpr unsigned int n_neighbours = dim == 2 ? 9 : 27;

      /// 22 bits of distance, then 42 bits of place.
      std::uint64_t
      name(const double distance, const dealii::Point<dim> &X) const
      {
        constexpr unsigned int bits = 42 / dim;
        std::uint64_t          name = std::llround(1e6 * distance / box.cell_size.norm());
        for (unsigned int d = 0; d < dim; ++d)
          name = name << bits | static_cast<std::uint64_t>((X[d] - box.lower[d]) / (box.upper()[d] - box.lower[d]) *
                                                           ((1u << bits) - 1));
        return name;
      }

      const GridBox<dim>                                        &box;
      std::vector<LocalState<dim>>                               states;
      std::unordered_map<std::int64_t, std::vector<std::size_t>> bins;
      std::size_t                                                found = 0;
    };
  } // namespace

  template <int dim>
  class MpmMethod<dim>::View : public Output::StateView
  {
  public:
    explicit View(const MpmMethod &method)
      : method(method)
    {}

    std::size_t
    n_points() const override
    {
      return method.points->n_owned();
    }
    void for_each_point(const Visit &visit) const override;
    void sample(const Output::StateFields &fields, Output::Samples &samples) const override;

  private:
    void find_local(const GatheredPoints<dim> &p, unsigned int q, unsigned int material,
                    const dealii::Tensor<1, dim> &u, LocalState<dim> &local) const;
    /// Calls visit(state, place now, undeformed volume, cell) for each point.
    template <typename VisitLocal>
    void for_each_local(const VisitLocal &visit) const;
    /// Answers by @p sampler, whose find(X) rates a place and whose state(X) gives the one found last.
    template <typename Sampler, typename Find>
    void ask(Sampler &sampler, double reach, const Find &find, const Output::StateFields &fields,
             Output::Samples &samples) const;

    void make_sampler() const;

    const MpmMethod                           &method;
    mutable std::unique_ptr<GridSampler<dim>>  grid_sampler;  ///< made when it is asked for, where the grid knows
    mutable std::unique_ptr<NearestPoint<dim>> nearest_point; ///< and where it does not
  };

  template <int dim>
  void
  MpmMethod<dim>::View::find_local(const GatheredPoints<dim> &p, const unsigned int q, const unsigned int material,
                                   const dealii::Tensor<1, dim> &u, LocalState<dim> &local) const
  {
    const auto &points = *method.points;
    local.X        = points.displacement.stored() ? points.initial_place(p.location[q], p.values[q]) : p.location[q];
    local.u        = u;
    local.material = material;
    if (points.displacement.stored())
      for (unsigned int d = 0; d < dim; ++d)
        local.u[d] += p.values[q][points.displacement.first + d];
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        local.F[i][k] = p.F[q][i][k];
    local.F33    = dim == 2 ? p.F33[q] : 1.;
    local.J      = determinant(local.F) * local.F33;
    local.cauchy = p.tau[q] / local.J;
    if (p.is_viscous)
      local.cauchy += symmetrize(p.viscous_stress(q, material)) / p.J[q];
  }

  template <int dim>
  template <typename VisitLocal>
  void
  MpmMethod<dim>::View::for_each_local(const VisitLocal &visit) const
  {
    LocalState<dim> local;
    method.system->for_each_cell(method.u, [&](const auto &active, GatheredPoints<dim> &p) {
      p.evaluate(Materials::stretch);
      for (const auto &run : p.runs)
        for (unsigned int q = run.begin; q < run.end; ++q)
          {
            const auto u = p.displacement(q);
            find_local(p, q, run.material, u, local);
            visit(local, dealii::Point<dim>(p.location[q] + u), p.initial_volume(q), active.cell);
          }
      return StepStatus::ok;
    });
  }

  template <int dim>
  void
  MpmMethod<dim>::View::for_each_point(const Visit &visit) const
  {
    PointState state;
    for_each_local([&](const auto &local, const dealii::Point<dim> &x, const double V0, const auto &cell) {
      copy(local, state);
      state.x    = Output::place_of<dim>(x);
      state.V0   = V0;
      state.cell = cell->active_cell_index();
      visit(state);
    });
  }

  template <int dim>
  template <typename Sampler, typename Find>
  void
  MpmMethod<dim>::View::ask(Sampler &sampler, const double reach, const Find &find, const Output::StateFields &fields,
                            Output::Samples &samples) const
  {
    const auto answer = [&](const Output::Place &place, double *values) {
      const auto   X      = Output::point_of<dim>(place);
      const Rating rating = find(X);
      if (rating == knows_not)
        return rating;
      const auto local = sampler.state(X);
      const auto state = is_elastic(method.scene) ? evaluate_law(method.scene, local) :
                                                    std::optional(point_state<dim>(local));
      if (!state)
        return knows_not;
      fields.fill(*state, values);
      return rating;
    };
    const auto comm = method.scene.comm;
    Output::ask_ranks(samples, fields.width(), Output::ranks_within(sampler.extent, reach, comm), answer, comm);
  }

  template <int dim>
  void
  MpmMethod<dim>::View::make_sampler() const
  {
    if (method.n_resets == 0 && method.settings.internal_force == InternalForce::consistent && is_elastic(method.scene))
      {
        Jumps<dim> jumps;
        method.system->for_each_jump(method.u, [&](const ActiveCell<dim> &active, const auto &by_material) {
          jumps.emplace(active.number, by_material);
        });
        grid_sampler = std::make_unique<GridSampler<dim>>(method.scene, *method.grid, *method.points,
                                                          method.system->on_grid(method.u), method.settings.projected,
                                                          std::move(jumps));
        return;
      }
    nearest_point = std::make_unique<NearestPoint<dim>>(method.grid->box());
    for_each_local([&](const auto &local, const auto &, const auto, const auto &) { nearest_point->add(local); });
  }

  template <int dim>
  void
  MpmMethod<dim>::View::sample(const Output::StateFields &fields, Output::Samples &samples) const
  {
    if (!grid_sampler && !nearest_point)
      make_sampler();
    const double h = method.grid->box().cell_size.norm();
    if (grid_sampler)
      ask(
        *grid_sampler, 1e-6 * h, [&](const auto &X) { return grid_sampler->find(X); }, fields, samples);
    else
      ask(
        *nearest_point, h,
        [&](const auto &X) {
          const auto material = method.scene.material_at(X);
          return material ? nearest_point->find(X, *material) : knows_not;
        },
        fields, samples);
  }

  template <int dim>
  std::unique_ptr<Output::StateView>
  MpmMethod<dim>::state(bool)
  {
    return std::make_unique<View>(*this);
  }

  template class MpmMethod<2>;
  template class MpmMethod<3>;
} // namespace Stroma::Mpm
