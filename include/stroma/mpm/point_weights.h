#pragma once

#include <stroma/mpm/points.h>

namespace Stroma::Mpm
{
  /**
   * Weights of the points in the sums over a cell, for a grid that was reset. Points that moved no longer integrate the cells
   * that they came into: cells get one or two of a row that was stretched by 1.3. So each point stands for the box that it has become,
   * a parallelogram of edges F^r s, in 2^dim parts, each taken for an upright box of its volume and cut by the cells' faces
   * (as the particles of GIMP, Bardenhagen & Kober 2004). In each cell the weights w are those nearest to their mean with
   *   sum_p w_p v_p phi_k(x_p) = sum of the parts' integrals of phi_k,     phi = 1, xi, eta, xi eta ...,  v = V J^r,
   * which makes uniform stress an equilibrium of linear shape functions wherever the boxes fill space. Where few points leave
   * some phi_k open, and where weights would fall below a fifth of their mean (less would leave points to themselves), they do what they can; the sum of volumes
   * always holds. Parts in cells without points count for the cell of their point.
   *
   * Sets Points::weight of the points on the active cells of @p grid. Collective.
   */
  template <int dim>
  void set_weights(Points<dim> &points, const BackgroundGrid<dim> &grid);
} // namespace Stroma::Mpm
