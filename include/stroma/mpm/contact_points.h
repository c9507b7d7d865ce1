#pragma once

#include <stroma/mpm/active_cells.h>
#include <stroma/rigid/contact_set.h>
#include <stroma/scene/scene.h>

namespace Stroma::Mpm
{
  /**
   * Points of the material's surface that may touch rigid bodies: one where a line of the grid's nodes meets the surface, so that
   * contact asks no more of the grid's field than that can follow, and of each node something (of B-splines nodes lie at the
   * centres of cells: a field may alternate from cell to cell and vanish at all their ends). Of the lines along the axis that the surface's normal is
   * closest to; a point's area is the integral of the linear function that is 1 on its line and 0 on the next ones. Where the
   * cell there holds no material point, the field of the first cell further in that does is continued.
   *
   * Those on cells of this rank and not wholly held. Throws UserError for images, and for a body of a contact that lies in the
   * material. Collective.
   */
  template <int dim>
  std::vector<Rigid::ContactPoint<dim>> contact_points(const Scene<dim> &scene, const BackgroundGrid<dim> &grid,
                                                       const ActiveCells<dim>     &cells,
                                                       const Solvers::Constraints &constraints);
} // namespace Stroma::Mpm
