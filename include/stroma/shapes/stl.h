#pragma once

#include <deal.II/base/point.h>

#include <array>
#include <string>
#include <vector>

namespace Stroma::Shapes
{
  /// Triangles as an STL file holds them, equal corners as one.
  struct Triangles
  {
    std::vector<dealii::Point<3>>            vertices;
    std::vector<std::array<unsigned int, 3>> corners;
  };

  /**
   * Reads the text of an STL file, ASCII or binary. The normals in it are not used: the order of the corners tells them.
   * Throws UserError, without the file's name, if it is no STL or ends too early.
   */
  Triangles read_stl(const std::string &bytes);
} // namespace Stroma::Shapes
