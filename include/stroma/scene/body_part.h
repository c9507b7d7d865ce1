#pragma once

#include <stroma/scene/scene.h>

namespace Stroma
{
  /// Exact volume of a body, whatever covers it, or area in 2D [m^dim].
  template <int dim>
  double volume_of(const Body<dim> &body);

  /// What a body takes up of a box, of a cell of a lattice for example.
  template <int dim>
  struct BodyPart
  {
    double             whole   = 0; ///< volume, whatever covers it [m^dim]
    double             visible = 0; ///< volume that no later body covers [m^dim]
    dealii::Point<dim> centroid;    ///< of the visible part, if there is any [m]
  };

  /**
   * The part of the box from @p lower to @p upper that body @p b of @p scene takes up. Exact for boxes among boxes (what is
   * within 1e-9 of the box's edges counts as on them); where a curved or slanted surface or an image cuts through, measured
   * by 16 (in 3D 8) samples along each edge. A body that is an image is taken to fill the box: it is a part of a voxel.
   */
  template <int dim>
  BodyPart<dim> part_in(const Scene<dim> &scene, unsigned int b, const dealii::Point<dim> &lower,
                        const dealii::Point<dim> &upper);
} // namespace Stroma
