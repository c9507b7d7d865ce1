#pragma once

#include <stroma/particles/neighbours.h>
#include <stroma/particles/wall_facets.h>
#include <stroma/sph/settings.h>

#include <deal.II/base/symmetric_tensor.h>

#include <memory>

namespace Stroma::Sph
{
  /**
   * Geometry of the pairs within the support, row by row, for particles where they are: what the sums over pairs need, and
   * nothing that depends on a material.
   *
   * A fixed particle j beyond a wall stands for the material's continuation: its velocity relative to the wall's, seen from i,
   * is extrapolated along the line between them, v_j - v_i = beta (v_w - v_i) with beta = 1 + depth of j / distance of i
   * (Morris 1997). All sums are quadratic forms in such differences, so this is a pair with the point where the line crosses
   * the wall: r/beta, weight beta^2 P, area vector beta c, and the wall's velocity there. Each has an index of its own behind
   * the particles', so that fields over particles and wall points serve all pairs alike. Published pairs have beta = 1, and
   * end in the fixed particle itself.
   *
   * Walls of facets need no fixed particle: a row has one such pair with each part of a wall that its particle sees
   * (WallFacets), whose area vector and weight follow from the exact integral of the kernel over it,
   *   c_iw = -4 V_i grad gamma_iw/gamma_i,     P_iw = |c_iw|/(2 d),     d the distance of i from the wall,
   * and pairs of particles i and j grow by (1/gamma_i + 1/gamma_j)/2, so that sums of second moments stay what they are inside.
   *
   * Published pairs with facets, segments z of rigid bodies, leave pairs of particles alone and have boundary particles besides:
   *   c_iz = -2 V_i grad gamma_iz,     friction V_i |grad gamma_iz|/max(d, dp) along the wall alone ((25), (27) of Heck 2017),
   * with the factor 1/gamma_i of their rows left out (row_factor()): so the matrix is symmetric.
   */
  template <int dim>
  class Pairs
  {
  public:
    Pairs(const Scene<dim> &scene, const std::vector<Mover<dim>> &movers, const Settings &settings);

    /// Everything below, of particles and ghosts where they are at time @p t. Returns moved_too_far if two particles are on
    /// top of each other. @param poses of rigid bodies then, by mover. Collective.
    StepStatus update(const ParticleSet<dim> &particles, const Neighbours<dim> &neighbours, double t,
                      const std::vector<Rigid::Pose<dim>> &poses);

    unsigned int
    n_rows() const
    {
      return static_cast<unsigned int>(row_start.size()) - 1;
    }
    std::size_t
    n_pairs() const
    {
      return j.size();
    }
    unsigned int
    n_points() const
    {
      return n_particles + static_cast<unsigned int>(walls.size());
    } ///< particles, ghosts, wall points
    unsigned int
    first_wall_point() const
    {
      return n_particles;
    }

    /// Where a pair meets a wall.
    struct WallPoint
    {
      unsigned int       mover; ///< whose wall it is: a held side, or a rigid body
      dealii::Point<dim> X;     ///< place on it, undeformed [m]: it moves as the mover does there
      dealii::Tensor<1, dim>
        normal; ///< of length 1, into the material, of the surface nearest to the row's particle, turned with the mover
      double gap;            ///< distance of the row's particle from that surface; negative behind it [m]
      double missing;        ///< what the pair stands for of the kernel's integral beyond the wall
      bool   slides = false; ///< whether only velocities and forces along the normal count
      bool   flat   = false; ///< of facets: whether what is seen of the wall has one normal
    };
    std::vector<WallPoint> walls;

    /// A pair with a rigid body that has a contact: there only while its particle is in touch with the body.
    struct Touching
    {
      unsigned int i; ///< particle
      std::size_t  p; ///< pair
      unsigned int contact;
      bool         slides; ///< frictionless: one pair a particle, with the nearest place of the body
    };
    std::vector<Touching>     touching; ///< by rows
    std::vector<std::uint8_t> in_touch; ///< whether a row has such pairs; empty: no body has a contact

    /// Velocities @p v of the points: those of wall points along which a particle slides follow it.
    void let_slide(std::vector<dealii::Tensor<1, dim>> &v) const;
    /// Of @p force, one of a pair that meets a wall: what acts along the wall's normal.
    dealii::Tensor<1, dim>
    along_normal(const std::size_t p, const dealii::Tensor<1, dim> &force) const
    {
      return (force * wall(p).normal) * wall(p).normal;
    }
    bool
    slides(const std::size_t p) const
    {
      return meets_wall_point(p) && wall(p).slides;
    }
    /// Pairs in `touching` have no part in hourglass control: they are none of the undeformed material.
    void leave_out_touching();

    bool
    meets_wall_point(const std::size_t p) const
    {
      return j[p] >= n_particles;
    }
    /// That of pair @p p, which meets one.
    const WallPoint &
    wall(const std::size_t p) const
    {
      return walls[j[p] - n_particles];
    }

    /// Of pair @p p, one with a wall: whose it is, and the undeformed place that it ends at [m]. Published pairs end in the fixed
    /// particle itself.
    unsigned int
    mover(const ParticleSet<dim> &particles, const std::size_t p) const
    {
      return meets_wall_point(p) ? wall(p).mover : particles.mover[j[p]];
    }
    const dealii::Point<dim> &
    place_on_wall(const ParticleSet<dim> &particles, const std::size_t p) const
    {
      return meets_wall_point(p) ? wall(p).X : particles.X[j[p]];
    }

    std::vector<unsigned int> row_start;   ///< free neighbours first in each row, from row_start[i] to row_fixed[i]
    std::vector<unsigned int> row_fixed;   ///< fixed ones from there to row_start[i + 1]
    std::vector<unsigned int> j;           ///< the neighbour: a particle, or n_particles and on: a wall point
    std::vector<dealii::Tensor<1, dim>> r; ///< x_j - x_i, over beta [m]
    std::vector<double>                 P; ///< V_i V_j F_ij beta^2 [m^(dim - 2)], F = -W'/r
    std::vector<dealii::Tensor<1, dim>> c; ///< area vector from i to j [m^(dim - 1)], c_ij = -c_ji between free ones
    std::vector<double> face;              ///< part of r on i's side of the pair's face; empty: half of it (Interfaces)
    std::vector<double> friction;          ///< V_i V_j F_ij r^2/(r^2 + eta^2) beta, the weight of (16) [m^(dim - 2)]

    std::vector<double> volume_share; ///< part of a row's volume that AreaVectors gives to its gradient; empty: all

    /// @p sums [points] = sums over the pairs of each row, where each pair of two free particles of this rank is asked for once:
    /// row(i) returns what gives the part of pair p in row i's sum; @p sign times that, 1 or -1, is the part in the neighbour's.
    template <int sign, typename T, typename Row>
    void sum_up(std::vector<T> &sums, const Row &row) const;

    /// f += force of all pairs on free particles, as in sum_up(), minus it on the neighbour.
    template <typename Row>
    void
    add_forces(std::vector<dealii::Tensor<1, dim>> &f, const Row &row) const
    {
      sum_up<-1>(forces, row);
      for (unsigned int i = 0; i < n_free; ++i)
        f[i] += forces[i];
    }

    /// Whether walls are facets, and the scene has some.
    bool
    has_facets() const
    {
      return facets != nullptr;
    }

    /// Whether rows are multiplied by row_factor(): where published pairs meet segments.
    bool
    has_segments() const
    {
      return facets && settings.has_segments();
    }
    bool
    is_rigid(const unsigned int mover) const
    {
      return movers[mover].rigid != nullptr;
    }
    /// gamma_i, by which row @p i's balance of forces is multiplied; else 1.
    double
    row_factor(const unsigned int i) const
    {
      return has_segments() ? gamma[i] : 1.;
    }

    /// psi of particle @p i, (33) of Heck 2017, of the neighbours that were found, or of the material among them.
    double kernel_sum(const ParticleSet<dim> &particles, unsigned int i, bool material_only = false) const;

  private:
    void resize(std::size_t n_pairs);
    void look_at_facets(const ParticleSet<dim> &particles, const Neighbours<dim> &neighbours, double t,
                        const std::vector<Rigid::Pose<dim>> &poses);
    void look_at_segments(const ParticleSet<dim> &particles, unsigned int i);
    /// Adds pairs with what particle @p i sees of walls behind pair @p q; returns the number of pairs.
    unsigned int add_facets(const ParticleSet<dim> &particles, unsigned int i, unsigned int q);
    unsigned int add_segments(const ParticleSet<dim> &particles, unsigned int i, unsigned int q);
    void         share_friction(unsigned int i, unsigned int q);
    bool         may_meet(const ParticleSet<dim> &particles, unsigned int i, unsigned int k) const;
    bool         may_meet_mover(const ParticleSet<dim> &particles, unsigned int i, unsigned int m) const;
    unsigned int add_touching(const ParticleSet<dim> &particles, unsigned int i, unsigned int end);
    unsigned int join(unsigned int first, unsigned int end);
    void         find_later(const ParticleSet<dim> &particles, unsigned int i);
    /// Makes pair @p p, one with a fixed particle, one with the point of the wall. @param missing what it stands for.
    void add_wall_point(const ParticleSet<dim> &particles, unsigned int i, std::size_t p, double missing, double t);
    /// Place, as the wall stood at the start, where the pair meets the wall that particle @p k lies beyond, @p r away from it.
    dealii::Point<dim> place_on_wall(const ParticleSet<dim> &particles, unsigned int k, const dealii::Tensor<1, dim> &r,
                                     double t) const;
    void               extrapolate(std::size_t p, double beta);
    template <typename KernelType>
    StepStatus add_rows(const ParticleSet<dim> &particles, const Neighbours<dim> &neighbours, const KernelType &kernel,
                        double t);
    void       find_turns(const ParticleSet<dim> &particles, double t);
    /// What takes the surroundings of the fixed particle @p k back to where the wall stood at the start.
    const dealii::Tensor<2, dim> &
    turn_back(const ParticleSet<dim> &particles, const unsigned int k) const
    {
      const unsigned int m = particles.mover[k];
      return movers[m].deforms() ? turns[k].back : rotated_back[m];
    }

    const Scene<dim>              &scene;
    const std::vector<Mover<dim>> &movers;
    const Settings                 settings;
    unsigned int                   n_particles = 0; ///< with ghosts
    unsigned int                   n_free      = 0; ///< of this rank

    /// Of each row, its first free neighbour with a higher id. From there to row_fixed are all pairs of two free particles once, but
    /// for those of `others_first`, whose other particle has its row on another rank, or is an image.
    std::vector<unsigned int> row_later;
    struct RowPair
    {
      unsigned int i, p;
    };
    std::vector<RowPair>                        others_first;
    mutable std::vector<dealii::Tensor<1, dim>> forces; ///< of the last add_forces(), of points

    std::vector<dealii::Tensor<2, dim>> rotated_back; ///< inverse of each mover's rotation
    struct Turn
    {
      dealii::Tensor<2, dim> there, back; ///< Mover::gradient_of_motion() and its inverse
    };
    std::vector<Turn> turns; ///< of particles, where a side deforms

    std::unique_ptr<WallFacets<dim>>            facets;     ///< where walls are
    std::vector<typename WallFacets<dim>::Part> parts;      ///< of walls that particles see, row by row
    std::vector<unsigned int>                   part_start; ///< of the rows
    std::vector<double>                         gamma;      ///< part of the kernel that walls leave, ghosts included

    std::vector<int> contact_of; ///< each mover: index of its contact, -1: bonded; empty: none has one

    const double least_gap;     ///< between a particle and a wall [m]
    double       F_factor = 1.; ///< makes sums of second moments exact on the lattice; published: 1
  };

  template <int dim>
  template <int sign, typename T, typename Row>
  void
  Pairs<dim>::sum_up(std::vector<T> &sums, const Row &row) const
  {
    sums.assign(n_points(), T());
    const auto *const neighbour = j.data();
    auto *const       sum       = sums.data();
    for (unsigned int i = 0; i < n_free; ++i)
      {
        T                  own{};
        const auto         of_pair = row(i);
        const unsigned int both = row_fixed[i], end = row_start[i + 1];
        for (unsigned int p = row_later[i]; p < both; ++p)
          {
            const T part = of_pair(p);
            own += part;
            if constexpr (sign > 0)
              sum[neighbour[p]] += part;
            else
              sum[neighbour[p]] -= part;
          }
        for (unsigned int p = both; p < end; ++p)
          own += of_pair(p);
        sum[i] += own;
      }
    for (const auto &[i, p] : others_first)
      sum[i] += row(i)(p);
    for (unsigned int i = n_free; i < n_rows() && sign > 0;
         ++i) // fixed particles, which forces are not asked of, have all their pairs
      {
        const auto of_pair = row(i);
        for (unsigned int p = row_start[i]; p < row_start[i + 1]; ++p)
          sum[i] += of_pair(p);
      }
    // What came to ghosts and walls is no sum.
  }
} // namespace Stroma::Sph
