#pragma once

#include <stroma/image/volume.h>

namespace Stroma::Image
{
  /// A volume of merged voxels, and how many blocks had several most frequent labels.
  template <typename T>
  struct MergedVolume : Volume<T>
  {
    std::size_t n_ties = 0;
  };

  /**
   * Merge blocks of block[0] x block[1] x block[2] voxels into one voxel, which takes the label most voxels of the
   * block have; of labels that are equally frequent the lowest. Throws UserError if a block edge is zero or does not
   * divide the volume's size. Instantiated for std::uint8_t and std::uint16_t.
   */
  template <typename T>
  MergedVolume<T> merge_labels(const Volume<T> &labels, const std::array<unsigned int, 3> &block);
} // namespace Stroma::Image
