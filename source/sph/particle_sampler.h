#pragma once

#include "least_squares.h"
#include "particle_state.h"

#include <stroma/output/remote_places.h>
#include <stroma/particles/neighbours_cells.h>
#include <stroma/particles/periodic.h>

namespace Stroma::Sph
{
  /**
   * The committed state at any place, from the particles around by LeastSquares: of solids at undeformed places, of fluids at
   * places in space, as finite elements have them. Particles of another solid material do not count. Space is divided into
   * cells, of which each rank has those with its share of all nodes, and the nodes within reach of them: it answers for places
   * there.
   *
   * The motion takes in the held walls as well, on whose surface displacement and velocity are known: at the foot of
   * each fixed particle of the first layer, or where the first layer sees facets. Published fixed particles count as they are.
   */
  template <int dim>
  class ParticleSampler
  {
  public:
    /// @param time of the state [s]. Collective.
    ParticleSampler(const System<dim> &system, double time);

    /// Fills in the values of @p fields at the samples' places; none are found outside of the bodies, or where there are too few
    /// particles. Collective.
    void sample(const Output::StateFields &fields, Output::Samples &samples) const;

    /// Gradients of displacement and velocity at the owned free particles.
    struct Gradients
    {
      bool                   found = false;
      dealii::Tensor<2, dim> u, v; ///< [1], [1/s]
    };
    /// Collective.
    std::vector<Gradients> gradients() const;

  private:
    static constexpr double       radius_over_spacing = 3.;
    static constexpr unsigned int n_motion            = 2 * dim; ///< u, v
    static constexpr unsigned int n_stress            = 7;       ///< Cauchy stress, pressure

    /// What ranks get to know of a particle.
    struct Node
    {
      std::uint64_t                id;
      int                          group;
      bool                         is_free;
      std::array<double, dim>      place;
      std::array<double, n_motion> motion;
      std::array<double, n_stress> stress; ///< of free ones

      template <typename Archive>
      void
      serialize(Archive &archive, const unsigned int)
      {
        archive &id &group &is_free &place &motion &stress;
      }
    };

    /// How far nodes count [m].
    double
    reach() const
    {
      return LeastSquares<dim>::widening * radius;
    }
    std::vector<Node> nodes_of_particles(double time) const;
    void              lay_cells(const std::vector<Node> &nodes);
    std::vector<Node> nodes_of_cells(const std::vector<Node> &nodes) const;
    Node              node_of_free(const StateReader<dim> &state_of, unsigned int i) const;
    bool              node_of_fixed(Node &node, unsigned int i, double time) const;
    void              add_nodes_of_facets(std::vector<Node> &nodes, double time) const;
    Node              node_of_wall(std::uint64_t id, unsigned int m, const dealii::Point<dim> &X, double time) const;
    bool              state_at(const dealii::Point<dim> &place, Output::PointState &state) const;
    bool              fit_motion(const dealii::Point<dim> &place, int group, Output::PointState &state) const;
    void              ask(Output::Samples &samples, unsigned int width,
                          const std::function<bool(const dealii::Point<dim> &, double *)> &fill) const;
    dealii::Point<dim>
    folded(const dealii::Point<dim> &place) const
    {
      return Particles::folded<dim>(place, system.scene.bounding_box(), system.scene.periodic);
    }
    int
    group_of(const unsigned int material) const
    {
      return system.has_solids() ? static_cast<int>(material) : 0;
    }

    const System<dim> &system;
    const double       radius; ///< [m]
    Cells<dim>         cells;
    LeastSquares<dim>  motion, stress;
  };
} // namespace Stroma::Sph
