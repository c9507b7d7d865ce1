#pragma once

#include <stroma/shapes/shape.h>

#include <optional>

namespace Stroma::Shapes
{
  /// The part s of the way @p from - @p to at which a place first meets the surface from outside; 0 if it starts within the
  /// shape, nothing if it passes by. Sphere tracing (J. C. Hart, Vis. Comput. 12 (1996) 527).
  template <int dim>
  std::optional<double> first_meeting(const Shape<dim> &shape, const dealii::Point<dim> &from,
                                      const dealii::Point<dim> &to);
} // namespace Stroma::Shapes
