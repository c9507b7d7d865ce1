#pragma once

#include <stroma/rigid/rotation.h>
#include <stroma/sph/system.h>

namespace Stroma::Sph
{
  /**
   * Islands: sets of free particles, each of them connected by pairs, that no chain of pairs connects with a wall, a held particle
   * or, where a scene has neither, with the particle of the lowest id. A single particle is one as well. Nor do rigid bodies hold
   * them that the balance of forces moves, unless these touch what is held or have a drag.
   *
   * Without inertia nothing tells how an island moves as a whole. Of the motions that balance its forces it takes the one
   * that adds up to nothing and does not turn: sum_i v_i = 0, sum_i y_i x v_i = 0, y from the mean of its places. The operator of a
   * step is so P A P, P the projection on such motions; forces that P takes away are loads without an answer (driven_by()), or
   * moments that rounding and the closing of area vectors leave in the sums over pairs.
   */
  template <int dim>
  class Islands
  {
  public:
    using Velocities = std::vector<dealii::Tensor<1, dim>>;

    explicit Islands(const System<dim> &system)
      : system(system)
    {}

    /// Those of the pairs as they are. Collective.
    void find();

    struct Island
    {
      unsigned int       n_particles = 0;
      dealii::Point<dim> X; ///< undeformed place of the one with the lowest id [m]
    };
    const std::vector<Island> &
    all() const
    {
      return islands;
    } ///< the same on all ranks
    std::uint64_t n_particles() const;

    /// Whether free particle @p i is in one.
    bool
    has(const unsigned int i) const
    {
      return !in_island.empty() && in_island[i] != 0;
    }

    /// A rigid body that the balance of forces moves and that nothing holds; "" if there is none.
    const std::string &
    loose_body() const
    {
      return body;
    }

    /// The first island that @p loads on free particles push or turn; null if none is. Collective.
    const Island *driven_by(const Velocities &loads) const;

    /// Takes the motion of each island as a whole out of @p v, velocities of or forces on free particles. Collective.
    void remove_rigid_motions(dealii::Tensor<1, dim> *v) const;

    /// What the diagonal of a preconditioner needs more, where the block of a particle of an island has this trace.
    static double shift(double trace);

  private:
    static constexpr unsigned int n_turns = Rigid::n_rotations<dim>, n_modes = dim + n_turns;

    /// What find() follows particles with.
    struct Search;
    void                find_unheld(Search &search) const;
    void                share_with_bodies(Search &search) const;
    void                label(Search &search) const;
    void                number(const Search &search);
    void                measure();
    std::vector<double> sums_of(const dealii::Tensor<1, dim> *v) const;

    struct Member
    {
      unsigned int           i, island;
      dealii::Tensor<1, dim> y; ///< from the island's centre, as if the scene did not repeat [m]
    };
    using Turning = dealii::Tensor<2, n_turns>;

    const System<dim>                 &system;
    std::vector<Island>                islands;
    std::vector<Member>                members;   ///< of this rank
    std::vector<std::uint8_t>          in_island; ///< by free particle; empty: there are none
    std::vector<std::array<bool, dim>> repeats;   ///< whether each island meets itself across the scene's period
    std::vector<Turning> inverse_inertia; ///< of each, of unit masses; 0 about axes that it cannot turn about [1/m^2]
    std::string          body;
  };
} // namespace Stroma::Sph
