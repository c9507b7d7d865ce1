#pragma once

#include <stroma/image/volume.h>

#include <cstdint>
#include <vector>

namespace Stroma::Image
{
  /**
   * Thickness of what a mask (voxels that are not 0) shows [m], sorted: 2 d - h/2 at each voxel of its ridge, where the
   * distance d to the nearest voxel outside is not smaller than at the neighbours round it. h, the smallest edge of a voxel,
   * takes away that d goes from centre to centre. So a tube has its diameter and a plate its thickness, to half a voxel. The
   * image's border counts as inside. Empty where the mask is.
   * Distances: Maurer, Qi and Raghavan 2003, by ITK.
   */
  std::vector<double> ridge_thickness(const Volume<std::uint8_t> &mask);
} // namespace Stroma::Image
