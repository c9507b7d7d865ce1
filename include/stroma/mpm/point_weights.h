#pragma once

#include <stroma/mpm/points.h>

namespace Stroma::Mpm
{
  /**
   * Weights of the points in the sums over a cell, for a grid that was reset. Points that moved no longer integrate the cells
   * that they came into: cells get one or two of a row that was stretched by 1.3. With what the points cover of a cell
   * (CoveredMoments) the weights w are those nearest to their mean with
   *   sum_p w_p v_p phi_k(x_p) = covered moment of phi_k,     phi = 1, xi, eta, xi eta ...,  v = V J^r.
   * Where few points leave some phi_k open, and where weights would fall below a fifth of their mean (less would leave points to themselves), they do
   * what they can. What the mean gradients lack then is made up by a shift c_a of those of the cell,
   *   sum_p w_p v_p (g_a(x_p) + c_a) = covered integral of g_a,
   * so that uniform stress is an equilibrium wherever the boxes fill space (variationally consistent integration, Chen, Hillman & Rueter 2013).
   * Linear fields keep their gradients, since sum_a c_a = 0 and sum_a x_a (x) c_a = 0.
   *
   * Sets Points::weight and Points::gradient_shift on the active cells of @p grid. Both follow from what the points store. Collective.
   */
  template <int dim>
  void set_weights(Points<dim> &points, const BackgroundGrid<dim> &grid);
} // namespace Stroma::Mpm
