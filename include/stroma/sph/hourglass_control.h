#pragma once

#include <stroma/sph/elasticity.h>

#include <optional>

namespace Stroma::Sph
{
  /**
   * Elastic forces of hourglass control, from where particles are and where they were at the start. With x_ij = x_j - x_i now,
   * X_ij the same of undeformed places, and F_i the deformation gradient of least squares with weights P_ij X_ij (x) X_ij,
   *   E = 1/2 sum_ij a_i P_ij |d_ij|^2,     d_ij = x_ij - F_i X_ij,     a_i that of Elasticity of moduli G,
   * and across interfaces between materials, where F is that of the own material alone,
   *   E = 1/2 sum_across k P |J|^2,         J_ij = x_ij - (theta F_i + (1 - theta) F_j) X_ij
   * (after Ganzenmueller 2015). Forces are minus the gradient of E at given a and P: so they sum up to 0 and have no torque, turn with
   * the material, and have no history. In rates, with the geometry of now, Elasticity has the same.
   *
   * This takes material that keeps its neighbours. Where rows of particles are stretched by more than 1.6 they gather in pairs
   * all the same, see share_apart(). Pairs whose length has changed by more than `largest_change` have no part, nor
   * have those with bodies in contact, and with sides whose displacement is not known.
   */
  template <int dim>
  class HourglassControl
  {
  public:
    using Vector = dealii::Tensor<1, dim>;
    /// Displacements of wall points since the start [m]; none: not known.
    using OfWalls = std::vector<std::optional<Vector>>;

    /// @param elasticity, and @p interfaces, if there are any: updated before
    HourglassControl(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours, const Elasticity<dim> &elasticity,
                     const Interfaces<dim> *interfaces);

    /// For pairs that were found with @p particles (ghosts included) where they are, and walls displaced by @p of_walls. Collective.
    void update(const ParticleSet<dim> &particles, const OfWalls &of_walls);

    /// Share of the rows with stiffness, on all ranks, one of whose neighbours of the start has gone to more than twice the distance.
    /// Collective.
    double share_apart() const;

    /// Whether all neighbours of row @p i are those of the start, so that displacements @p u of the points tell its strain.
    bool knows_start(unsigned int i, const std::vector<Vector> &u) const;

    /// Takes the stiffness of Elasticity, which degradation changes. Collective.
    void set_stiffness();

    /// Forces with @p particles (ghosts included) where they are now, and walls displaced by @p of_walls. Collective.
    void find_forces(const ParticleSet<dim> &particles, const OfWalls &of_walls);

    /// f += those found last, on free particles [N].
    void add_forces(std::vector<Vector> &f) const;
    /// The same within one material, pair by pair, for Pairs::add_forces().
    auto
    rows() const
    {
      return [j = pairs.j.data(), X_of = X.data(), P_of = P.data(), x_of = x.data(), h = aH.data(),
              a_of = a.data()](const unsigned int i) {
        return [=, x_i = x_of[i], h_i = h[i], a_i = a_of[i]](const unsigned int p) -> Vector {
          const unsigned int k = j[p];
          return P_of[p] * ((a_i + a_of[k]) * (x_of[k] - x_i - X_of[p]) - (h_i + h[k]) * X_of[p]);
        };
      };
    }
    /// The part of pair @p p of row @p i, one with a wall, in it.
    Vector
    pair_force(const unsigned int i, const std::size_t p) const
    {
      const unsigned int j = pairs.j[p];
      return P[p] * ((a[i] + a[j]) * stretch(i, p) - (aH[i] + aH[j]) * X[p]);
    }

    /// E of the forces found last, of this rank [J/m^(3 - dim)].
    double energy() const;

  private:
    /// x_ij - X_ij.
    Vector
    stretch(const unsigned int i, const std::size_t p) const
    {
      return x[pairs.j[p]] - x[i] - X[p];
    }
    /// Whether the two of pair @p p are neighbours as they were at the start.
    bool   keeps(std::size_t p) const;
    Vector undeformed(const ParticleSet<dim> &particles, const OfWalls &of_walls, unsigned int i, std::size_t p);
    void   place(const ParticleSet<dim> &particles, const OfWalls &of_walls);
    void   add_jumps();
    bool   has_come_apart(unsigned int i) const;

    const Pairs<dim>            &pairs;
    const Neighbours<dim>       &neighbours;
    const Elasticity<dim>       &elasticity;
    const Interfaces<dim> *const interfaces;
    bool                         repeats = false; ///< whether places have images

    // Of pairs.
    std::vector<Vector>                 X;              ///< X_ij [m]
    std::vector<double>                 P;              ///< 0 of those that have no part
    std::vector<dealii::Point<dim>>     wall_start;     ///< of wall points: undeformed place, in the periods of now [m]
    std::vector<dealii::Tensor<2, dim>> inverse_moment; ///< (sum_j P X (x) X)^-1 of rows
    std::vector<double>                 a;              ///< of points; 0 where nothing resists
    std::vector<double>                 across;         ///< k P of the pairs across

    // As found last.
    std::vector<dealii::Point<dim>>     x;    ///< places of the points [m]
    std::vector<dealii::Tensor<2, dim>> sums; ///< sum_j P (x_ij - X_ij) (x) X_ij of rows
    std::vector<dealii::Tensor<2, dim>> H;    ///< F - I of rows, ghosts included
    std::vector<dealii::Tensor<2, dim>> aH; ///< what forces come of: a_i H_i, and what jumps do through H_i; of points
    std::vector<Vector>                 jumps; ///< of the pairs across
  };
} // namespace Stroma::Sph
