#pragma once

#include <stroma/image/connectivity.h>
#include <stroma/image/volume.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace Stroma::Image
{
  /// The connected pieces of a mask (voxels that are not 0).
  struct Pieces
  {
    /// 1, 2, ... from the largest piece on, of equal ones that which comes first in the volume; 0 outside.
    Volume<std::uint32_t> number;
    /// Voxels of each piece, the largest first.
    std::vector<std::size_t> size;
  };

  Pieces find_pieces(const Volume<std::uint8_t> &mask, Connectivity connectivity);

  /// Fills what a ball of this radius [m] cannot get into from outside (closing). Beyond the image there is
  /// nothing.
  /// Throws UserError if the radius is below all edges of a voxel, so that it would do nothing, or above 50 of the smallest.
  void close_gaps(Volume<std::uint8_t> &mask, double radius);
} // namespace Stroma::Image
