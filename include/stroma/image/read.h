#pragma once

#include <stroma/image/volume.h>

#include <cstdint>
#include <optional>
#include <string>

namespace Stroma::Image
{
  /**
   * Read a volume image or a single slice: TIFF stack (.tif, .tiff), NRRD (.nrrd), NIfTI (.nii, .nii.gz) or
   * MetaImage (.mha) with one 8- or 16-bit integer a voxel and no negative values.
   *
   * Voxels keep the file's order and axes; the file's origin and direction cosines are not used: the result's corner
   * is at zero.
   *
   * @param voxel_size   edge lengths of a voxel [m]; if not given the file's spacing times `spacing_unit`. Must be
   * given for TIFF, whose spacing cannot be trusted (a resolution in dots per inch, often a default; what ImageJ and
   * OME write elsewhere is not read).
   * @param spacing_unit length of one unit of the file's spacing [m]
   *
   * Throws UserError, naming the file, when it is missing, damaged or cut off, of an unknown format, has several
   * components (colours), other number types or negative values, or when the voxel size is missing or not positive.
   */
  Volume<std::uint16_t> read(const std::string                          &path,
                             const std::optional<std::array<double, 3>> &voxel_size   = std::nullopt,
                             double                                      spacing_unit = 1e-6);
} // namespace Stroma::Image
