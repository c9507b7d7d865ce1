#pragma once

#include <stroma/image/volume.h>

namespace Stroma::Image
{
  /// The median of the box of 2 radius + 1 voxels round each voxel; beyond the image its outermost values go on.
  Volume<float> median(const Volume<float> &image, const std::array<unsigned int, 3> &radius);

  /**
   * The image smoothed by the discrete Gaussian, e^-t I_n(t) with t the variance in voxels (Lindeberg 1990), whose width is
   * right however few voxels it spans; beyond the image its outermost values go on. A single slice is smoothed in its plane.
   * @param deviation standard deviation [m]. Throws UserError if it is more than 8 of the smallest edge of a voxel.
   * @param beyond share of the Gaussian beyond which it is cut off
   */
  Volume<float> gaussian(const Volume<float> &image, double deviation, double beyond = .0005);
} // namespace Stroma::Image
