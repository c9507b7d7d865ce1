#include <stroma/mpm/driven_points.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>

namespace Stroma::Mpm
{
  template <int dim>
  DrivenPoints<dim>::DrivenPoints(const Scene<dim> &scene, const Settings<dim> &settings,
                                  const BackgroundGrid<dim> &grid, const Points<dim> &points, ActiveCells<dim> &cells)
    : scene(scene)
    , points(points)
    , cells(cells)
    , cell_size(grid.box().cell_size)
    , h(*std::min_element(grid.box().cell_size.begin_raw(), grid.box().cell_size.end_raw()))
    , penalty(settings.penalty)
    , reaction(scene.supports.size())
  {}

  template <int dim>
  void
  DrivenPoints<dim>::find_held_places()
  {
    using Kind        = typename Region<dim>::Kind;
    const auto bodies = scene.bounding_box();
    held.assign(scene.supports.size(), std::nullopt);
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      if (const auto &region = scene.supports[s].region; region.kind == Kind::side)
        {
          held[s].emplace();
          held[s]->along[region.axis] = true;
          held[s]->place[region.axis] = region.side_coordinate(bodies);
        }
      else if (region.kind == Kind::nearest && points.weight.stored())
        held[s] = centre_of(s);
  }

  /// Of the points that support @p s drives; none where it acts on nodes. Halves lie symmetrically about the point that they come
  /// from, so that their centre is its place. Collective.
  template <int dim>
  std::optional<typename DrivenPoints<dim>::Held>
  DrivenPoints<dim>::centre_of(const unsigned int s) const
  {
    std::array<long double, dim + 1> sums{}; // of V X and V: no digit of a double may tell their order
    for (const auto &point : points.handler)
      {
        const auto numbers = point.get_properties();
        if (!points.is_marked(numbers.data(), points.support, s))
          continue;
        const long double V = numbers[points.volume.first];
        const auto        X = points.initial_place(point.get_location(), numbers.data());
        for (unsigned int d = 0; d < dim; ++d)
          sums[d] += V * X[d];
        sums[dim] += V;
      }
    for (auto &sum : sums)
      sum = dealii::Utilities::MPI::sum(sum, scene.comm);
    if (!(sums[dim] > 0.))
      return std::nullopt;
    Held centre;
    centre.along.fill(true);
    for (unsigned int d = 0; d < dim; ++d)
      centre.place[d] = static_cast<double>(sums[d] / sums[dim]);
    return centre;
  }

  template <int dim>
  void
  DrivenPoints<dim>::rebuild()
  {
    holders.clear();
    if (!points.support.stored())
      return;
    find_held_places();
    for (const auto &active : cells)
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        if (point.get_properties()[points.support.first] != 0.)
          {
            holders.push_back(&active);
            break;
          }
  }

  template <int dim>
  template <typename Act>
  void
  DrivenPoints<dim>::for_springs(const ActiveCell<dim> &active, const Act &act) const
  {
    for (const auto &point : points.handler.particles_in_cell(active.cell))
      {
        const auto numbers = point.get_properties();
        const auto mask    = static_cast<unsigned long long>(numbers[points.support.first]);
        if (mask == 0)
          continue;
        Spring       spring;
        const double modulus = scene.materials[points.material_of(numbers.data())]->p_wave_modulus();
        spring.stiffness     = penalty * modulus * numbers[points.volume.first] / (h * h);
        spring.shapes        = cells.shapes(active, point.get_reference_location());
        spring.X             = points.initial_place(point.get_location(), numbers.data());
        for (unsigned int c = 0; c < dim && points.displacement.stored(); ++c)
          spring.before[c] = numbers[points.displacement.first + c];
        for (spring.support = 0; spring.support < scene.supports.size(); ++spring.support)
          if (mask >> spring.support & 1)
            act(held[spring.support] ? at(*held[spring.support], spring, active, point) : spring);
      }
  }

  /// The spring at the place that the deformation of @p point carries along, by the functions of its own cell @p active.
  template <int dim>
  typename DrivenPoints<dim>::Spring
  DrivenPoints<dim>::at(const Held &held, Spring spring, const ActiveCell<dim> &active,
                        const typename Points<dim>::Accessor &point) const
  {
    const double          *numbers = point.get_properties().data();
    dealii::Tensor<1, dim> arm;
    for (unsigned int d = 0; d < dim; ++d)
      if (held.along[d])
        arm[d] = held.place[d] - spring.X[d];
    spring.X += arm;
    const auto now = points.deformation_of(numbers) * arm;
    spring.before += now - arm;
    auto xi = point.get_reference_location();
    for (unsigned int d = 0; d < dim; ++d)
      xi[d] += now[d] / cell_size[d];
    spring.shapes = cells.shapes(active, xi);
    return spring;
  }

  /// Displacement of the place less its target, in the components that are prescribed; in stages that end before the step
  /// does from velocities, see Solvers::Stage.
  template <int dim>
  dealii::Tensor<1, dim>
  DrivenPoints<dim>::gap(const Spring &spring, const ActiveCell<dim> &active, const Solvers::Motion &motion,
                         const Solvers::Stage &stage) const
  {
    const auto            &displacement = scene.supports[spring.support].displacement;
    const auto             has          = cells.value(active, spring.shapes, stage.is_last ? motion.u : motion.v);
    dealii::Tensor<1, dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      if (!displacement.is_free(c))
        result[c] = stage.is_last ?
                      has[c] - displacement.value(spring.X, stage.t, c) + spring.before[c] :
                      (has[c] - displacement.rate(spring.X, stage.t, c, stage.dt / 1024.)) / stage.v_factor;
    return result;
  }

  template <int dim>
  StepStatus
  DrivenPoints<dim>::add_force(Vector &r, const Solvers::Motion &motion, const Solvers::Stage &stage)
  {
    std::fill(reaction.begin(), reaction.end(), dealii::Tensor<1, dim>());
    largest = squares = 0.;
    if (!points.support.stored())
      return StepStatus::ok;
    cells.add_nodal(r, [&](std::vector<double> &nodal) {
      for (const auto *active : holders)
        {
          const double largest_u = cells.largest(*active, motion.u);
          double       summed    = 0; // by the cell, before anything cancels: gap = displacement - target
          for_springs(*active, [&](const Spring &spring) {
            const auto   d = gap(spring, *active, motion, stage);
            const double k = spring.stiffness;
            for (unsigned int a = 0; a < cells.n_nodes; ++a)
              for (unsigned int c = 0; c < dim; ++c)
                nodal[active->node[a] + c] -= k * d[c] * spring.shapes.value[a];
            summed += 2. * k * (largest_u + spring.before.norm() + d.norm());
            reaction[spring.support] -= k * d;
            largest = std::max(largest, d.norm());
          });
          squares += summed * summed;
        }
    });
    return StepStatus::ok;
  }

  template <int dim>
  StepStatus
  DrivenPoints<dim>::add_tangent(Matrix &K, Vector &r, const Solvers::Motion &, const Solvers::Stage &,
                                 const Solvers::Constraints &constraints)
  {
    if (!points.support.stored())
      return StepStatus::ok;
    typename ActiveCells<dim>::Assembly assembly(cells, K, r, constraints);
    dealii::FullMatrix<double>          K_cell(dim * cells.n_nodes);
    for (const auto *active : holders)
      {
        K_cell = 0.;
        for_springs(*active, [&](const Spring &spring) {
          for (unsigned int c = 0; c < dim; ++c)
            if (!scene.supports[spring.support].displacement.is_free(c))
              for (unsigned int a = 0; a < cells.n_nodes; ++a)
                for (unsigned int b = 0; b < cells.n_nodes; ++b)
                  K_cell(a * dim + c, b * dim + c) += spring.stiffness * spring.shapes.value[a] *
                                                      spring.shapes.value[b];
        });
        assembly.add(*active, K_cell);
      }
    return StepStatus::ok;
  }

  template <int dim>
  double
  DrivenPoints<dim>::round_off() const
  {
    return std::numeric_limits<double>::epsilon() * std::sqrt(dealii::Utilities::MPI::sum(squares, scene.comm));
  }

  template <int dim>
  double
  DrivenPoints<dim>::largest_gap() const
  {
    return dealii::Utilities::MPI::max(largest, scene.comm);
  }

  template class DrivenPoints<2>;
  template class DrivenPoints<3>;
} // namespace Stroma::Mpm
