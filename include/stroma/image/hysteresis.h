#pragma once

#include <stroma/image/connectivity.h>
#include <stroma/image/volume.h>

#include <cstdint>

namespace Stroma::Image
{
  /**
   * Hysteresis threshold: 1 (vessel) for voxels with value >= lower that are connected, through voxels with
   * value >= lower, to one with value >= upper; 0 (background) elsewhere. Both thresholds are inclusive; lower == upper
   * is a plain threshold.
   *
   * Throws UserError if lower > upper or one of them is not a number.
   * Instantiated for std::uint8_t, std::uint16_t and float.
   */
  template <typename T>
  Volume<std::uint8_t> hysteresis_threshold(const Volume<T> &image, double lower, double upper,
                                            Connectivity connectivity);
} // namespace Stroma::Image
