#pragma once

#include <stroma/particles/mover.h>
#include <stroma/particles/particle_set.h>
#include <stroma/rigid/mass.h>
#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  using namespace Particles;

  /**
   * The rigid bodies that the balance of forces moves. Their unknowns q are the components of velocity [m/s] and, times a length of
   * the body, of angular velocity that the balance determines, body by body; the forces that belong to them are components of
   * force and of torque over that length [N], in the plane for 1 m of thickness. All ranks know all of them.
   *
   * A pair of particle i with a place of a body acts on the body with minus its force on i: with wall velocities U + omega x rho the
   * operators of particles and bodies together are symmetric. Where rows of particles are multiplied by a factor
   * (Pairs::row_factor), what acts on the body is the force itself, and they are not.
   */
  template <int dim>
  class BodyBalance
  {
  public:
    using Velocities = std::vector<dealii::Tensor<1, dim>>;
    using Twists     = std::vector<Rigid::Twist<dim>>; ///< by mover
    using Unknowns   = std::vector<double>;

    BodyBalance(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers);

    /// Number of unknowns.
    unsigned int
    size() const
    {
      return static_cast<unsigned int>(unknowns.size());
    }
    bool
    moves(const unsigned int mover) const
    {
      return first[mover] < first[mover + 1];
    }

    /// For the pairs as they are: which of them end at these bodies. @param poses when the pairs were found. Collective.
    void update(const ParticleSet<dim> &particles, const Pairs<dim> &pairs, const std::vector<Rigid::Pose<dim>> &poses);

    /// Whether the body @p mover has a pair, on any rank.
    bool
    touches(const unsigned int mover) const
    {
      return n_pairs[mover] > 0;
    }
    /// Whether it resists by itself where it touches nothing.
    bool resists(unsigned int mover) const;

    /// Components that the balance determines of @p twists, and the other way round: those of @p q, others are 0.
    Unknowns unknowns_of(const Twists &twists) const;
    Twists   twists_of(const Unknowns &q) const;

    /// Velocities of the places at which pairs end: those of @p q, or theirs and those of @p q. Local.
    void set_velocities(Velocities &v, const Unknowns &q) const;
    void add_velocities(Velocities &v, const Unknowns &q) const;

    /// Forces on the bodies of those on particles: visit(i, add) calls add(p, force on particle i) for the pairs of row i that end
    /// at walls. Collective.
    template <typename VisitRow>
    Unknowns
    forces(const VisitRow &visit) const
    {
      std::vector<Rigid::Wrench<dim>> wrenches(n_pairs.size());
      for (const auto &row : rows)
        visit(row.i, [&](const std::size_t p, const dealii::Tensor<1, dim> &f) {
          const End &end = ends[row.first + (p - row.first_pair)];
          if (end.mover != none)
            wrenches[end.mover].add(end.arm, -row.inverse_factor * f);
        });
      return sum(wrenches);
    }

    /// Wrenches by mover, of this rank, as forces on the unknowns, summed over the ranks. Collective.
    Unknowns sum(const std::vector<Rigid::Wrench<dim>> &wrenches) const;
    /// Wrenches by mover of forces on the unknowns, 0 for other components.
    std::vector<Rigid::Wrench<dim>> wrenches_of(const Unknowns &forces) const;

    /// Matrix of the unknowns of what is spread evenly over each mover's shape, @p amounts by mover: of masses, or drags.
    dealii::FullMatrix<double> spread(const std::vector<double> &amounts) const;
    /// Masses by mover [kg, of 1 m in the plane].
    std::vector<double> masses() const;

    /// Rates of @p q under @p forces on the unknowns and @p resisting, a matrix or nothing.
    Unknowns rates(const Unknowns &forces, const Unknowns &q, const dealii::FullMatrix<double> &resisting,
                   const dealii::FullMatrix<double> &inverse_mass) const;

    /// Of loads at time @p t [s].
    Unknowns loads(double t) const;
    /// The smallest of @p loads on a body that has one [N]; infinite where none has.
    double least_of(const Unknowns &loads) const;

    /// Sets what resists besides the pairs in a step of @p dt [s] that has the loads of time @p t: drag, and what keeps a body that
    /// touches nothing to its largest approach.
    void set_resistance(double t, double dt);
    const dealii::FullMatrix<double> &
    resistance() const
    {
      return drag;
    }
    /// Force of the drag of velocities @p twists, given components included.
    Unknowns drag_force(const Twists &twists) const;

    /// Sum over the pairs of blocks between neighbours alone, as a matrix of the unknowns: block(i, p) is that of pair p of row i.
    /// Collective.
    template <typename Block>
    dealii::FullMatrix<double>
    sum_of_blocks(const Block &block) const
    {
      dealii::FullMatrix<double> sum(size(), size());
      for (const auto &row : rows)
        for (std::size_t e = row.first; e < row.first + row.size; ++e)
          if (ends[e].mover != none)
            add_block(sum, ends[e], block(row.i, row.first_pair + (e - row.first)));
      dealii::Utilities::MPI::sum(sum, scene.comm, sum);
      return sum;
    }

    /// Calls visit(i, p, u, velocity) for the pairs p of rows i that end at a body: the velocity there of its unknown u = 1.
    template <typename Visit>
    void
    visit_ends(const Visit &visit) const
    {
      for (const auto &row : rows)
        for (std::size_t e = row.first; e < row.first + row.size; ++e)
          for (unsigned int u = 0; ends[e].mover != none && u < size(); ++u)
            if (unknowns[u].mover == ends[e].mover)
              visit(row.i, row.first_pair + (e - row.first), u, motion(u, ends[e].arm));
    }

    const Scene<dim>              &scene;
    const std::vector<Mover<dim>> &movers;

  private:
    static constexpr unsigned int none = static_cast<unsigned int>(-1);

    struct Unknown
    {
      unsigned int mover, motion; ///< number among Rigid::n_motions
    };
    /// Of a pair, in the order of the pairs in the rows.
    struct End
    {
      unsigned int           mover; ///< none: not one of these bodies
      dealii::Tensor<1, dim> arm;   ///< from the pivot [m]
    };
    /// Whose velocity is that of a body: where pairs end.
    struct Place
    {
      unsigned int           mover, point;
      dealii::Tensor<1, dim> arm; ///< [m]
    };
    struct Row
    {
      unsigned int i;
      std::size_t  first_pair, first, size; ///< of the pairs with walls, and of ends
      double       inverse_factor;          ///< 1/Pairs::row_factor
    };

    void find_places(const ParticleSet<dim> &particles, const Pairs<dim> &pairs);
    /// From where the pivot was when the pairs were found.
    dealii::Tensor<1, dim>
    arm(const unsigned int m, const dealii::Point<dim> &X) const
    {
      return rotation[m] * (X - poses[m].pivot);
    }
    double
    thickness() const
    {
      return dim == 2 ? scene.thickness : 1.;
    }
    /// Velocity at the end of @p arm of unknown @p k = 1.
    dealii::Tensor<1, dim> motion(unsigned int k, const dealii::Tensor<1, dim> &arm) const;
    void add_block(dealii::FullMatrix<double> &sum, const End &end, const dealii::SymmetricTensor<2, dim> &block) const;

    std::vector<Unknown>                unknowns;
    std::vector<unsigned int>           first;   ///< unknown of each mover, and behind the last one
    std::vector<double>                 length;  ///< of each mover [m]
    std::vector<std::uint64_t>          n_pairs; ///< of each mover, of all ranks
    std::vector<Row>                    rows;    ///< of this rank's particles that see such a body
    std::vector<End>                    ends;
    std::vector<Place>                  places;
    std::vector<Rigid::Pose<dim>>       poses;    ///< when the pairs were found
    std::vector<dealii::Tensor<2, dim>> rotation; ///< of these
    std::vector<double>                 drag_now; ///< c of each mover [N s/m^2 in the plane]
    dealii::FullMatrix<double>          drag;
    Unknowns                            acting; ///< loads
  };
} // namespace Stroma::Sph
