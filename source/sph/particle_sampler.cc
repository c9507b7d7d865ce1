#include "particle_sampler.h"

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  namespace
  {
    template <int dim>
    dealii::Tensor<1, dim>
    normal_of(const Mover<dim> &wall, const Scene<dim> &scene, const dealii::Point<dim> &X, const double step)
    {
      dealii::Tensor<1, dim> normal;
      for (unsigned int d = 0; d < dim; ++d)
        {
          const auto e = step * dealii::Point<dim>::unit_vector(d);
          normal[d]    = (wall.distance(scene, X + e) - wall.distance(scene, dealii::Point<dim>(X - e))) / (2. * step);
        }
      return normal;
    }

    template <int dim>
    dealii::Point<dim>
    point(const std::array<double, dim> &place)
    {
      dealii::Point<dim> result;
      std::copy(place.begin(), place.end(), result.begin_raw());
      return result;
    }

    template <int dim>
    void
    set_motion(std::array<double, 2 * dim> &motion, const dealii::Tensor<1, dim> &u, const dealii::Tensor<1, dim> &v)
    {
      std::copy(u.begin_raw(), u.end_raw(), motion.begin());
      std::copy(v.begin_raw(), v.end_raw(), motion.begin() + dim);
    }
  } // namespace

  template <int dim>
  ParticleSampler<dim>::ParticleSampler(const System<dim> &system, const double time)
    : system(system)
    , motion(radius_over_spacing * system.settings.arrangement.spacing, system.scene.bounding_box(),
             system.scene.periodic, n_motion)
    , stress(radius_over_spacing * system.settings.arrangement.spacing, system.scene.bounding_box(),
             system.scene.periodic, n_stress)
  {
    const auto mine = nodes_of_this_rank(time);
    for (const Node &node : mine)
      own.add(Output::place_of<dim>(folded(point<dim>(node.place))));
    auto nodes = with_near_ones(mine);
    std::sort(nodes.begin(), nodes.end(), [](const Node &a, const Node &b) { return a.id < b.id; });
    for (const Node &node : nodes)
      {
        motion.add(point<dim>(node.place), node.group, node.motion.data());
        if (node.is_free)
          stress.add(point<dim>(node.place), node.group, node.stress.data());
      }
    motion.finish();
    stress.finish();
  }

  template <int dim>
  double
  ParticleSampler<dim>::reach() const
  {
    return LeastSquares<dim>::widening * radius_over_spacing * system.settings.arrangement.spacing;
  }

  template <int dim>
  dealii::Point<dim>
  ParticleSampler<dim>::folded(dealii::Point<dim> place) const
  {
    const auto box = system.scene.bounding_box();
    for (unsigned int d = 0; d < dim; ++d)
      if (system.scene.periodic[d])
        place[d] -= box.side_length(d) * std::floor((place[d] - box.lower_bound(d)) / box.side_length(d));
    return place;
  }

  /// Whether a place or one of its periodic images is within @p distance of @p extent.
  template <int dim>
  bool
  ParticleSampler<dim>::is_near(const Output::Extent &extent, const dealii::Point<dim> &place,
                                const double distance) const
  {
    const auto   box      = system.scene.bounding_box();
    unsigned int n_images = 1;
    for (unsigned int d = 0; d < dim; ++d)
      n_images *= 3;
    for (unsigned int k = 0; k < n_images; ++k)
      {
        auto image    = folded(place);
        bool is_image = true;
        for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
          {
            image[d] += (rest % 3 - 1.) * box.side_length(d);
            is_image &= rest % 3 == 1 || system.scene.periodic[d];
          }
        if (is_image && extent.distance(Output::place_of<dim>(image)) <= distance)
          return true;
      }
    return false;
  }

  /// A place within reach() of extent() needs the nodes within reach() of it.
  template <int dim>
  std::vector<typename ParticleSampler<dim>::Node>
  ParticleSampler<dim>::with_near_ones(const std::vector<Node> &mine) const
  {
    const auto                                extents = Output::all_extents(own, system.scene.comm);
    std::map<unsigned int, std::vector<Node>> near;
    for (const Node &node : mine)
      for (unsigned int rank = 0; rank < extents.size(); ++rank)
        if (is_near(extents[rank], point<dim>(node.place), 2. * reach()))
          near[rank].push_back(node);
    std::vector<Node> nodes;
    for (const auto &[rank, of_rank] : dealii::Utilities::MPI::some_to_some(system.scene.comm, near))
      nodes.insert(nodes.end(), of_rank.begin(), of_rank.end());
    return nodes;
  }

  template <int dim>
  std::vector<typename ParticleSampler<dim>::Node>
  ParticleSampler<dim>::nodes_of_this_rank(const double time) const
  {
    const auto            &particles = system.particles;
    const StateReader<dim> state_of(system);
    std::vector<Node>      nodes;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      nodes.push_back(node_of_free(state_of, i));
    Node node{};
    for (unsigned int i = particles.n_free; i < particles.n_owned; ++i)
      if (node_of_fixed(node, i, time))
        nodes.push_back(node);
    return nodes;
  }

  template <int dim>
  typename ParticleSampler<dim>::Node
  ParticleSampler<dim>::node_of_free(const StateReader<dim> &state_of, const unsigned int i) const
  {
    const auto place = place_of(system, i);
    const auto state = state_of(i);
    Node       node{};
    node.id      = system.particles.id[i];
    node.group   = group_of(state.material);
    node.is_free = true;
    std::copy(place.begin_raw(), place.end_raw(), node.place.begin());
    set_motion<dim>(node.motion, system.displacement(i), system.particles.v[i]);
    std::copy(state.cauchy.begin_raw(), state.cauchy.end_raw(), node.stress.begin());
    node.stress[6] = state.pressure;
    return node;
  }

  /// False for one that tells nothing of the wall.
  template <int dim>
  bool
  ParticleSampler<dim>::node_of_fixed(Node &node, const unsigned int i, const double time) const
  {
    const auto       &particles = system.particles;
    const auto       &scene     = system.scene;
    const double      dp        = system.settings.arrangement.spacing;
    const Mover<dim> &wall      = system.movers[particles.mover[i]];
    const double      distance  = wall.distance(scene, particles.X[i]);
    auto              place     = place_of(system, i);
    auto              u = system.displacement(i), v = particles.v[i];
    if (!system.settings.published())
      {
        const dealii::Point<dim> foot = particles.X[i] - distance * normal_of(wall, scene, particles.X[i], 1e-4 * dp);
        if (distance < -dp || !scene.bounding_box().point_inside(foot, 1e-6))
          return false;
        place += foot - particles.X[i];
        v = wall.velocity(scene, foot, time);
        if (wall.gives_displacement)
          u = wall.displacement(scene, foot, time);
      }
    node.id      = particles.id[i];
    node.group   = LeastSquares<dim>::any_group;
    node.is_free = false;
    node.stress.fill(0.);
    std::copy(place.begin_raw(), place.end_raw(), node.place.begin());
    set_motion<dim>(node.motion, u, v);
    return true;
  }

  template <int dim>
  bool
  ParticleSampler<dim>::fit_motion(const dealii::Point<dim> &place, const int group, Output::PointState &state) const
  {
    std::array<double, n_motion>       values;
    std::array<double, n_motion * dim> gradients;
    if (!motion.fit(place, group, values.data(), gradients.data()))
      return false;
    for (unsigned int c = 0; c < dim; ++c)
      {
        state.u[c] = values[c];
        state.v[c] = values[dim + c];
        for (unsigned int d = 0; d < dim; ++d)
          {
            state.u_gradient[c][d] = gradients[c * dim + d];
            state.v_gradient[c][d] = gradients[(dim + c) * dim + d];
          }
      }
    return true;
  }

  template <int dim>
  bool
  ParticleSampler<dim>::state_at(const dealii::Point<dim> &place, Output::PointState &state) const
  {
    const auto material = system.scene.material_at(place);
    if (!material || !fit_motion(place, group_of(*material), state))
      return false;
    std::array<double, n_stress>       values;
    std::array<double, n_stress * dim> gradients;
    if (!stress.fit(place, group_of(*material), values.data(), gradients.data()))
      return false;
    state.material = *material;
    state.pressure = values[6];
    if (system.has_solids())
      std::copy(values.begin(), values.begin() + 6, state.cauchy.begin_raw());
    else
      {
        state.cauchy = -state.pressure * dealii::unit_symmetric_tensor<3>();
        if (system.is_viscous())
          state.cauchy += friction_stress(system.scene.media[*material], state.v_gradient);
      }
    return true;
  }

  template <int dim>
  void
  ParticleSampler<dim>::set_gradients(const unsigned int i, Output::PointState &state) const
  {
    Output::PointState fitted;
    if (!fit_motion(place_of(system, i), group_of(state.material), fitted))
      return;
    state.u_gradient = fitted.u_gradient;
    state.v_gradient = fitted.v_gradient;
  }

  template class ParticleSampler<2>;
  template class ParticleSampler<3>;
} // namespace Stroma::Sph
