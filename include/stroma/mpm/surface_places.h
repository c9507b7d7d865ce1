#pragma once

#include <stroma/scene/body.h>

namespace Stroma::Mpm
{
  /// A place on a body's surface that stands for a part of it.
  template <int dim>
  struct SurfacePlace
  {
    dealii::Point<dim>     X;      ///< [m]
    dealii::Tensor<1, dim> normal; ///< outward
    double                 area;   ///< [m^(dim-1)]
  };

  /// Places all over the surface of a drawn body, about @p spacing [m] apart.
  template <int dim>
  std::vector<SurfacePlace<dim>> surface_places(const Body<dim> &body, double spacing);
} // namespace Stroma::Mpm
