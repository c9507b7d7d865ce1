#include <stroma/image/crop.h>

#include "words.h"

#include <stroma/base/counted.h>
#include <stroma/base/errors.h>

#include <algorithm>
#include <cstdint>
#include <string>

namespace Stroma::Image
{
  template <typename T>
  Volume<T>
  crop(const Volume<T> &volume, const std::array<unsigned int, 3> &first, const std::array<unsigned int, 3> &size)
  {
    Volume<T> part{size, volume.voxel_size, volume.origin, {}};
    for (unsigned int d = 0; d < 3; ++d)
      {
        if (size[d] == 0 || size[d] > volume.size[d] || first[d] > volume.size[d] - size[d])
          throw UserError("cannot take " + counted(size[d], "voxel") + " from voxel " + std::to_string(first[d]) +
                          " on along " + axis_names[d] + ": the image has " + std::to_string(volume.size[d]) +
                          " there, counted from 0");
        part.origin[d] += first[d] * volume.voxel_size[d];
      }
    part.data.resize(part.n_voxels());
    for (unsigned int z = 0; z < size[2]; ++z)
      for (unsigned int y = 0; y < size[1]; ++y)
        std::copy_n(&volume.at(first[0], first[1] + y, first[2] + z), size[0], &part.at(0, y, z));
    return part;
  }

  template Volume<std::uint8_t>  crop(const Volume<std::uint8_t> &, const std::array<unsigned int, 3> &,
                                      const std::array<unsigned int, 3> &);
  template Volume<std::uint16_t> crop(const Volume<std::uint16_t> &, const std::array<unsigned int, 3> &,
                                      const std::array<unsigned int, 3> &);
  template Volume<float>         crop(const Volume<float> &, const std::array<unsigned int, 3> &,
                                      const std::array<unsigned int, 3> &);
} // namespace Stroma::Image
