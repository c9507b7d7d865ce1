#pragma once

#include <stroma/image/volume.h>

namespace Stroma::Image
{
  /**
   * The `size` voxels of `volume` from voxel `first` on; size[2] == 1 takes one slice. The part keeps its place: its
   * origin is that of its first voxel in the stack.
   * Throws UserError if the part is empty or reaches out of the volume.
   * Instantiated for std::uint8_t, std::uint16_t and float.
   */
  template <typename T>
  Volume<T> crop(const Volume<T> &volume, const std::array<unsigned int, 3> &first,
                 const std::array<unsigned int, 3> &size);
} // namespace Stroma::Image
