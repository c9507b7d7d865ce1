#pragma once

namespace Stroma::Image
{
  /// Which voxels touch: those that share a face (6 in 3D, 4 in 2D), or a face, edge or corner (26 or 8).
  enum class Connectivity
  {
    faces,
    full
  };
} // namespace Stroma::Image
