#pragma once

#include <stroma/image/volume.h>

namespace Stroma::Image
{
  /// The median of the box of 2 radius + 1 voxels round each voxel; beyond the image its outermost values go on.
  Volume<float> median(const Volume<float> &image, const std::array<unsigned int, 3> &radius);

  /**
   * The image smoothed by a Gaussian, cut off where half a per cent of it lies beyond; beyond the image its outermost
   * values go on. A single slice is smoothed in its plane.
   * @param deviation standard deviation [m]. Throws UserError if it is more than 20 of the smallest edge of a voxel.
   */
  Volume<float> gaussian(const Volume<float> &image, double deviation);
} // namespace Stroma::Image
