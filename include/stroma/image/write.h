#pragma once

#include <stroma/image/volume.h>

#include <string>

namespace Stroma::Image
{
  /// Throws UserError if write() would refuse the path for its extension, its folder or a file that is there.
  void check_target(const std::string &path, bool overwrite);

  /**
   * Write a volume (8 or 16 bit) as NRRD (.nrrd, gzip), MetaImage (.mha, zlib) or TIFF stack (.tif, .tiff, not
   * compressed), by the extension of `path`. Spacing and the first voxel's centre are written in micrometres, with that
   * unit; a TIFF does not keep them. A NRRD's coordinates are those of @p space (Frame::space).
   * The file appears under its name only when complete: it is written under a temporary name in the same folder, read
   * again, compared and then renamed.
   *
   * Throws UserError when the file exists and `overwrite` is false, when the extension is another one, or when the
   * folder or disk cannot take the file. Instantiated for std::uint8_t and std::uint16_t.
   */
  template <typename T>
  void write(const std::string &path, const Volume<T> &volume, bool overwrite = false, const std::string &space = "");
} // namespace Stroma::Image
