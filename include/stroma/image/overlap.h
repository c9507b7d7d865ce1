#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace Stroma::Image
{
  /// How far two sets of voxels agree.
  struct Overlap
  {
    std::size_t first = 0, second = 0, both = 0; ///< voxels

    /// 2 both / (first + second) (Dice 1945); 1 for two empty sets.
    double
    dice() const
    {
      return first + second == 0 ? 1. : 2. * both / (first + second);
    }

    /// both / (first or second) (Jaccard 1912); 1 for two empty sets.
    double
    jaccard() const
    {
      return first + second == 0 ? 1. : double(both) / (first + second - both);
    }
  };

  /// Of the voxels of each value, by value (256 of them). The two images have equally many voxels.
  std::vector<Overlap> overlaps(const std::vector<std::uint8_t> &first, const std::vector<std::uint8_t> &second);
} // namespace Stroma::Image
