#pragma once

#include <stroma/shapes/faceted.h>

#include <optional>

namespace Stroma::Shapes
{
  /// A place where an edge of the surface passes through the inside of one of its triangles, if there is one. Triangles that touch,
  /// or lie on each other, up to 1e-6 of their size, do not cross; an edge that passes exactly through another one is not seen.
  std::optional<dealii::Point<3>> self_crossing(const Triangles &all);
} // namespace Stroma::Shapes
