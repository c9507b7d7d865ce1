#pragma once

#include "stored.h"

#include <stroma/image/volume.h>

namespace Stroma::Image
{
  /// How stored axes lie along x, y, z: stored axis i runs along axis[i], backwards if reversed[i].
  struct Orientation
  {
    std::array<unsigned int, 3> axis     = {{0, 1, 2}};
    std::array<bool, 3>         reversed = {{false, false, false}};

    bool is_plain() const;

    /// For people: the stored axes in turn, for example "z, -y, x".
    std::string text() const;
  };

  /**
   * Orientation of the stored axes by the header's directions, which must be along its coordinates to 0.001; the third
   * of a two-dimensional image is square to the others. Throws UserError naming `path` if they are sheared or oblique.
   */
  Orientation orientation_of(const std::string &path, const Stored &stored);

  /// Throws UserError if the stored axes are not square to each other: voxels would be no boxes.
  void check_square(const std::string &path, const Stored &stored);

  /// The volume in the order of x, y, z; voxel_size stays as it is.
  template <typename T>
  std::vector<T> in_order(const std::vector<T> &stored, std::array<unsigned int, 3> &size,
                          const Orientation &orientation);
} // namespace Stroma::Image
