#pragma once

#include <stroma/sph/pairs.h>

namespace Stroma::Sph
{
  /**
   * The pressure of a fluid on its way from a particle to a wall. Fixed particles have no stress, so that pairs with them push
   * with the pressure of the particle itself, p_i: too little on a floor, by that of half a spacing of liquid, and beside any
   * wall the gradient of pressure along it that balances a weight is another one than inside. In corners nothing balances
   * then (.6 of the weight is left), and a liquid at rest creeps. With the pressure continued to the point of the wall (as
   * Adami, Hu, Adams 2012, J. Comput. Phys. 231, 7057, do by the balance of forces),
   *   f_i = -1/2 sum_w (r_iw . g_i) c_iw
   * is added, and a pressure that is linear in place balances a weight everywhere, since sum_j r (x) c = 2 V I includes walls.
   *
   * g_i is the mean, weighted by P, of the neighbours' gradients of least squares, (sum_k P r (x) r)^-1 sum_k P r (p_k - p_j),
   * over free particles. Without the mean, modes of pressure of the size of the spacing, which make no force inside, make one at
   * walls; NSPH, which takes g of a step's start, multiplies them by -1.01 to -1.1 a step in a vessel of 10 x 5 particles, with the
   * mean by less than .6.
   */
  template <int dim>
  class WallPressure
  {
  public:
    WallPressure(const Pairs<dim> &pairs, const Neighbours<dim> &neighbours) : pairs(pairs), neighbours(neighbours) {}

    /// For the pairs as they are now; @p n particles with ghosts. Collective.
    void update(unsigned int n);

    /// f += the forces at walls, on free particles [N]. @p stresses of fluids, ghosts included [Pa]. Collective.
    void add_force(std::vector<dealii::Tensor<1, dim>> &f, const std::vector<dealii::SymmetricTensor<2, dim>> &stresses);

    /// The part of pair @p p of row @p i, one with a wall, in it.
    dealii::Tensor<1, dim>
    pair_force(const unsigned int i, const std::size_t p) const
    {
      return -.5 * (at_wall[i] * pairs.r[p]) * pairs.c[p];
    }

  private:
    bool sees_wall(const unsigned int i) const { return pairs.row_fixed[i] < pairs.row_start[i + 1]; }
    void set_inverse_moment(unsigned int i);

    const Pairs<dim>                   &pairs;
    const Neighbours<dim>              &neighbours;
    std::vector<unsigned int>           rows;           ///< that see a wall, or have a neighbour that does
    std::vector<dealii::Tensor<2, dim>> inverse_moment; ///< of these rows; 0 where neighbours do not tell a gradient
    std::vector<dealii::Tensor<1, dim>> gradient;       ///< of least squares, of these rows; ghosts included [Pa/m]
    std::vector<dealii::Tensor<1, dim>> at_wall;        ///< g of free particles [Pa/m]
  };
} // namespace Stroma::Sph
