#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace Stroma::Output
{
  /// A field of a piece as it stands in the file.
  struct PieceField
  {
    std::string  name;
    unsigned int components; ///< 1, 3, 6 (VTK's order xx yy zz xy yz xz) or 9 (row by row)
  };

  /// Points and their fields that go into one file. Single precision, as visualisation needs.
  struct PointBlock
  {
    std::vector<float>              positions; ///< 3 a point [m]
    std::vector<std::vector<float>> values;    ///< for each field its components, point after point

    std::size_t
    n_points() const
    {
      return positions.size() / 3;
    }
  };
} // namespace Stroma::Output
