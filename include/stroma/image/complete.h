#pragma once

#include <cstdint>
#include <string>

namespace Stroma::Image
{
  /**
   * Check that a NIfTI-1 file, plain or gzip, holds `n_bytes` of voxels behind its header: ITK alone fills up a file
   * that was cut off with whatever is in memory. A gzip file's checksum is checked, too. Throws UserError naming the
   * file.
   */
  void check_nifti(const std::string &path, std::uint64_t n_bytes);

  /**
   * The same for a MetaImage file (.mha) and its zlib checksum; also throws if its voxels are in another file.
   * Source of the layout: MetaIO documentation, "ElementDataFile = LOCAL" ends the header.
   */
  void check_metaimage(const std::string &path, std::uint64_t n_bytes);
} // namespace Stroma::Image
