#include "particle_sampler.h"

#include <stroma/output/collective.h>

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
    auto nodes = Output::gather_all(nodes_of_this_rank(time), system.scene.comm);
    std::sort(nodes.begin(), nodes.end(), [](const Node &a, const Node &b) { return a.id < b.id; });
    for (const Node &node : nodes)
    {
      dealii::Point<dim> place;
      std::copy(node.place.begin(), node.place.end(), place.begin_raw());
      motion.add(place, node.group, node.motion.data());
      if (node.is_free)
        stress.add(place, node.group, node.stress.data());
    }
    motion.finish();
    stress.finish();
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
    Node node;
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
    Node       node;
    node.id      = system.particles.id[i];
    node.group   = group_of(state.material);
    node.is_free = true;
    std::copy(place.begin_raw(), place.end_raw(), node.place.begin());
    set_motion<dim>(node.motion, state.u, state.v);
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
  ParticleSampler<dim>::fit_motion(const dealii::Point<dim> &place, const int group, ParticleState<dim> &state) const
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
  ParticleSampler<dim>::state_at(const dealii::Point<dim> &place, ParticleState<dim> &state) const
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
  ParticleSampler<dim>::set_gradients(const unsigned int i, ParticleState<dim> &state) const
  {
    ParticleState<dim> fitted;
    if (!fit_motion(place_of(system, i), group_of(state.material), fitted))
      return;
    state.u_gradient = fitted.u_gradient;
    state.v_gradient = fitted.v_gradient;
  }

  template class ParticleSampler<2>;
  template class ParticleSampler<3>;
} // namespace Stroma::Sph
