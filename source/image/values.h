#pragma once

#include "stored.h"

#include <cstdint>

namespace Stroma::Image
{
  /**
   * The voxels of a file as numbers of type T, in the order of the file, scaled. Labels (std::uint16_t) must be whole
   * and 0 to 65535, within round-off of the scaling; grey values (float) must be finite. Throws UserError naming `path`
   * and the first value that is not. Instantiated for these two types.
   */
  template <typename T>
  std::vector<T> values_of(const std::string &path, const Stored &stored);
} // namespace Stroma::Image
