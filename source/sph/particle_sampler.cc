#include "particle_sampler.h"

#include <stroma/particles/border_volumes.h>
#include <stroma/particles/neighbours_ghosts.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Sph
{
  namespace
  {
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
    , radius(radius_over_spacing * system.settings.arrangement.spacing)
    , motion(radius, system.scene.bounding_box(), system.scene.periodic, n_motion)
    , stress(radius, system.scene.bounding_box(), system.scene.periodic, n_stress)
  {
    auto nodes = nodes_of_particles(time);
    lay_cells(nodes);
    nodes = nodes_of_cells(nodes);
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
  void
  ParticleSampler<dim>::lay_cells(const std::vector<Node> &nodes)
  {
    std::vector<dealii::Point<dim>> places;
    for (const Node &node : nodes)
      places.push_back(point<dim>(node.place));
    const auto &scene = system.scene;
    cells.lay(places, reach(), scene.bounding_box(), scene.periodic, scene.comm);
    cells.divide(places, scene.comm);
  }

  /// Those within reach() of this rank's cells.
  template <int dim>
  std::vector<typename ParticleSampler<dim>::Node>
  ParticleSampler<dim>::nodes_of_cells(const std::vector<Node> &nodes) const
  {
    std::map<unsigned int, std::vector<Node>> sent;
    GhostFinder<dim> finder(cells, system.scene.periodic, dealii::numbers::invalid_unsigned_int, reach());
    for (const Node &node : nodes)
      {
        unsigned int last = dealii::numbers::invalid_unsigned_int; // one suffices for all images
        finder.for_each_ghost(point<dim>(node.place), [&](const unsigned int rank, const std::uint8_t) {
          if (rank != last)
            sent[rank].push_back(node);
          last = rank;
        });
      }
    std::vector<Node> received;
    for (const auto &[rank, of_rank] : dealii::Utilities::MPI::some_to_some(system.scene.comm, sent))
      received.insert(received.end(), of_rank.begin(), of_rank.end());
    return received;
  }

  template <int dim>
  std::vector<typename ParticleSampler<dim>::Node>
  ParticleSampler<dim>::nodes_of_particles(const double time) const
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
    if (system.pairs.has_facets())
      add_nodes_of_facets(nodes, time);
    return nodes;
  }

  /// Where particles see a wall from less than a spacing away.
  template <int dim>
  void
  ParticleSampler<dim>::add_nodes_of_facets(std::vector<Node> &nodes, const double time) const
  {
    const auto &pairs = system.pairs;
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      {
        std::uint64_t of_wall = 0; // ids of particles end long before
        for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
          if (const auto &wall = pairs.wall(p); wall.gap < system.settings.arrangement.spacing)
            nodes.push_back(node_of_wall(system.particles.id[i] | (++of_wall << 56), wall.mover, wall.X, time));
      }
  }

  template <int dim>
  typename ParticleSampler<dim>::Node
  ParticleSampler<dim>::node_of_wall(const std::uint64_t id, const unsigned int m, const dealii::Point<dim> &X,
                                     const double time) const
  {
    const Mover<dim> &wall    = system.movers[m];
    const auto       &pose    = system.poses[m]; // of a side that moves as one, its translation
    const bool        deforms = !wall.rigid && wall.varies_in_space;
    const auto        u       = deforms ? wall.displacement(system.scene, X, time) : pose.displacement(X);
    const auto        place   = folded(system.has_solids() ? X : dealii::Point<dim>(X + u));
    Node              node{};
    node.id    = id;
    node.group = LeastSquares<dim>::any_group;
    std::copy(place.begin_raw(), place.end_raw(), node.place.begin());
    set_motion<dim>(node.motion, u,
                    !wall.rigid ? wall.velocity(system.scene, X, time) :
                    system.bodies && system.bodies->moves(m) ?
                                  system.wall_velocity(m, X) :
                                  wall.rigid->twist(time, wall.time_difference).at(pose.arm(X)));
    return node;
  }

  template <int dim>
  typename ParticleSampler<dim>::Node
  ParticleSampler<dim>::node_of_free(const StateReader<dim> &state_of, const unsigned int i) const
  {
    const auto place = folded(place_of(system, i));
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
    const Mover<dim> &wall      = system.movers[particles.mover[i]];
    const auto        surface   = wall.nearest(scene, particles.X[i]);
    auto              place     = place_of(system, i);
    auto              u = system.displacement(i), v = particles.v[i];
    if (!system.settings.published())
      {
        const auto &foot = surface.foot;
        if (surface.distance < -system.settings.arrangement.spacing ||
            !scene.bounding_box().point_inside(Particles::inside_periods(scene, foot), 1e-6))
          return false;
        const auto to_foot = foot - particles.X[i];
        if (wall.rigid)
          {
            const auto &pose = system.poses[particles.mover[i]];
            place += system.has_solids() ? to_foot : Rigid::rotation_matrix<dim>(pose.rotation) * to_foot;
            v = system.bodies && system.bodies->moves(particles.mover[i]) ?
                  system.wall_velocity(particles.mover[i], foot) :
                  wall.rigid->twist(time, wall.time_difference).at(pose.arm(foot));
            u = pose.displacement(foot);
          }
        else
          {
            place += to_foot;
            v = wall.velocity(scene, foot, time);
            if (wall.gives_displacement)
              u = wall.displacement(scene, foot, time);
          }
      }
    node.id      = particles.id[i];
    node.group   = LeastSquares<dim>::any_group;
    node.is_free = false;
    node.stress.fill(0.);
    place = folded(place);
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
    const auto material = Particles::material_at(system.scene, place);
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

  /// Asks the owners of the cells.
  template <int dim>
  void
  ParticleSampler<dim>::ask(Output::Samples &samples, const unsigned int width,
                            const std::function<bool(const dealii::Point<dim> &, double *)> &fill) const
  {
    Output::ask_ranks(
      samples, width,
      [&](const Output::Place &X) {
        return std::vector<unsigned int>(1, cells.owner_of(folded(Output::point_of<dim>(X))));
      },
      [&](const Output::Place &X, double *values) {
        return fill(folded(Output::point_of<dim>(X)), values) ? Output::Rating(0) : Output::knows_not;
      },
      system.scene.comm);
  }

  template <int dim>
  void
  ParticleSampler<dim>::sample(const Output::StateFields &fields, Output::Samples &samples) const
  {
    ask(samples, fields.width(), [&](const dealii::Point<dim> &X, double *values) {
      Output::PointState state;
      if (!state_at(X, state))
        return false;
      fields.fill(state, values);
      return true;
    });
  }

  template <int dim>
  std::vector<typename ParticleSampler<dim>::Gradients>
  ParticleSampler<dim>::gradients() const
  {
    constexpr unsigned int n = dim * dim;
    Output::Samples        samples;
    for (unsigned int i = 0; i < system.particles.n_free; ++i)
      samples.X.push_back(Output::place_of<dim>(place_of(system, i)));
    ask(samples, 2 * n, [&](const dealii::Point<dim> &X, double *values) {
      std::array<double, n_motion> of_motion;
      return motion.fit(X, motion.group_at(X), of_motion.data(), values);
    });
    std::vector<Gradients> gradients(samples.X.size());
    for (std::size_t i = 0; i < gradients.size(); ++i)
      {
        gradients[i].found = samples.found[i];
        gradients[i].u     = dealii::Tensor<2, dim>(dealii::ArrayView<const double>(&samples.values[2 * n * i], n));
        gradients[i].v     = dealii::Tensor<2, dim>(dealii::ArrayView<const double>(&samples.values[2 * n * i + n], n));
      }
    return gradients;
  }

  template class ParticleSampler<2>;
  template class ParticleSampler<3>;
} // namespace Stroma::Sph
