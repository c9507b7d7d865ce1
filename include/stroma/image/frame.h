#pragma once

#include <array>
#include <string>

namespace Stroma::Image
{
  /// Where a file puts its voxels, in the coordinates of its header along x, y, z.
  struct Frame
  {
    double                unit = 1e-6;         ///< length of one of its coordinates [m]
    std::array<double, 3> first{{0., 0., 0.}}; ///< centre of the first voxel
    std::string           space;               ///< name of the coordinates as NRRD has it, or empty
  };
} // namespace Stroma::Image
