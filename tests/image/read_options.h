#pragma once

#include <stroma/image/read.h>

/// Options with a voxel size [m].
inline Stroma::Image::ReadOptions
with_voxels(const std::array<double, 3> &voxel_size)
{
  Stroma::Image::ReadOptions options;
  options.voxel_size = voxel_size;
  return options;
}

/// Options with a unit of the spacing [m].
inline Stroma::Image::ReadOptions
with_unit(const double unit)
{
  Stroma::Image::ReadOptions options;
  options.spacing_unit = unit;
  return options;
}
