#pragma once

#include "least_squares.h"
#include "particle_state.h"

#include <stroma/output/remote_places.h>

namespace Stroma::Sph
{
  /**
   * The committed state at any place near this rank's particles, from the particles around by LeastSquares: of solids at
   * undeformed places, of fluids at places in space, as finite elements have them. Particles of another solid material
   * do not count.
   *
   * The motion takes in the held walls as well, on whose surface displacement and velocity are known: at the foot of
   * each fixed particle of the first layer. Published fixed particles count as they are.
   */
  template <int dim>
  class ParticleSampler
  {
  public:
    /// Takes in the other ranks' particles that are near this one's. @param time of the state [s]. Collective.
    ParticleSampler(const System<dim> &system, double time);

    /// False outside of the bodies, or where there are too few particles. Right within reach() of extent().
    bool state_at(const dealii::Point<dim> &place, Output::PointState &state) const;

    /// Replaces the gradients in the state of owned particle @p i.
    void set_gradients(unsigned int i, Output::PointState &state) const;

    /// Around this rank's nodes, folded into the period.
    const Output::Extent &
    extent() const
    {
      return own;
    }
    /// How far nodes count [m].
    double reach() const;
    /// @p place folded into the period.
    dealii::Point<dim> folded(dealii::Point<dim> place) const;

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

    std::vector<Node> nodes_of_this_rank(double time) const;
    std::vector<Node> with_near_ones(const std::vector<Node> &mine) const;
    bool              is_near(const Output::Extent &extent, const dealii::Point<dim> &place, double distance) const;
    Node              node_of_free(const StateReader<dim> &state_of, unsigned int i) const;
    bool              node_of_fixed(Node &node, unsigned int i, double time) const;
    bool              fit_motion(const dealii::Point<dim> &place, int group, Output::PointState &state) const;
    int
    group_of(const unsigned int material) const
    {
      return system.has_solids() ? static_cast<int>(material) : 0;
    }

    const System<dim> &system;
    Output::Extent     own;
    LeastSquares<dim>  motion, stress;
  };
} // namespace Stroma::Sph
