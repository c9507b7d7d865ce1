#pragma once

#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * The pressure of a fluid on its way from a particle to a wall. Fixed particles have no stress, so that a pair with a wall pushes
   * with the pressure of the particle itself: too little on a floor, by that of half a spacing of liquid; and along a wall a weight
   * is balanced by another gradient than inside. In corners nothing balances then (.6 of the weight is left over), and a liquid at
   * rest creeps. Here the mean stress m = -p is continued to the point of the wall,
   *   f_i += 1/2 sum_w (g_i . r_iw) c_iw,     g_i = M_i^-1 sum_j P r_ij (m_j - m_i),     M_i = sum_j P r_ij (x) r_ij,
   * j the free neighbours: a pressure that is linear in place balances a weight everywhere, since sum r (x) c = 2 V I includes
   * walls. (Adami, Hu, Adams 2012, J. Comput. Phys. 231, 7057, continue it by the balance of forces.) The dilatation is minus the
   * adjoint of the force,
   *   V_i tr L_i += -sum_j P (y_i + y_j) . r_ij,     y_i = -1/2 M_i^-1 sum_w ((v_i - v_w) . c_iw) r_iw,
   * so that energy is conserved and K_el symmetric. It adds up to nothing, and leaves a uniform shear along a wall as it is.
   */
  template <int dim>
  class WallPressure
  {
  public:
    WallPressure(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours)
      : pairs(pairs)
      , neighbours(neighbours)
    {}

    /// For the pairs as they are now. Collective.
    void update();

    /// values += V_i tr L_i of velocities @p v of all points, for rows [m^dim/s]. Collective.
    void add_dilatation(std::vector<double> &values, const std::vector<dealii::Tensor<1, dim>> &v) const;

    /// f += the forces of mean stresses @p m (ghosts included) at walls, on free particles [N].
    void add_force(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<double> &m) const;

    /// g_i of particle @p i; 0 if it sees no wall [Pa/m].
    dealii::Tensor<1, dim> gradient(unsigned int i, const std::vector<double> &m) const;

    /// The part of pair @p p, one with a wall, in the force.
    dealii::Tensor<1, dim>
    pair_force(const std::size_t p, const dealii::Tensor<1, dim> &g) const
    {
      return .5 * (g * pairs.r[p]) * pairs.c[p];
    }

  private:
    bool
    sees_wall(const unsigned int i) const
    {
      return pairs.row_fixed[i] < pairs.row_start[i + 1];
    }
    void set_inverse_moment(unsigned int i);

    const Pairs<dim>         &pairs;
    const Neighbours<dim>    &neighbours;
    std::vector<unsigned int> at_wall;   ///< rows that see a wall,
    std::vector<unsigned int> near_wall; ///< and those that have one of them as a neighbour as well
    std::vector<dealii::Tensor<2, dim>>
      inverse_moment; ///< M^-1 of rows at a wall; 0 where neighbours do not tell a gradient
    mutable std::vector<dealii::Tensor<1, dim>> y; ///< ghosts included
  };
} // namespace Stroma::Sph
