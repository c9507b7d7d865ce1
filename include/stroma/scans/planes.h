#pragma once

#include <stroma/image/volume.h>

#include <string>

namespace Stroma::Scans
{
  /**
   * Writes the three middle planes of a volume as PGM files, in rows along the plane's second axis:
   * <folder>/plane_xy_<name>.pgm, plane_xz_... and plane_yz_...; of a slice only the first. Values from @p low to @p high become
   * 0 to 255. Throws OutputError.
   */
  template <typename T>
  void write_planes(const std::string &folder, const std::string &name, const Image::Volume<T> &volume, double low,
                    double high);
} // namespace Stroma::Scans
