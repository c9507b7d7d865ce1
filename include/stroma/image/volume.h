#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace Stroma::Image
{
  /**
   * A volume image: a box of equal voxels, one value each. A 2D image has size[2] == 1.
   * The box fills [origin, origin + size * voxel_size]; its axes are the file's axes x, y, z.
   */
  template <typename T>
  struct Volume
  {
    /// Number of voxels along x, y, z.
    std::array<unsigned int, 3> size = {{0, 0, 0}};
    /// Edge lengths of a voxel [m].
    std::array<double, 3> voxel_size = {{1e-6, 1e-6, 1e-6}};
    /// Corner of the first voxel (not its centre) [m].
    std::array<double, 3> origin = {{0, 0, 0}};
    /// Values, x fastest, then y, then z.
    std::vector<T> data;

    std::size_t
    n_voxels() const
    {
      return std::size_t(size[0]) * size[1] * size[2];
    }

    /// Place of voxel (x, y, z) in `data`.
    std::size_t
    index(unsigned int x, unsigned int y, unsigned int z) const
    {
      return x + size[0] * (y + std::size_t(size[1]) * z);
    }

    const T &
    at(unsigned int x, unsigned int y, unsigned int z) const
    {
      return data[index(x, y, z)];
    }

    T &
    at(unsigned int x, unsigned int y, unsigned int z)
    {
      return data[index(x, y, z)];
    }
  };

  /// A volume of `value` with the size, voxels and place of `other`.
  template <typename T, typename U>
  Volume<T>
  volume_like(const Volume<U> &other, const T value)
  {
    return {other.size, other.voxel_size, other.origin, std::vector<T>(other.n_voxels(), value)};
  }
} // namespace Stroma::Image
