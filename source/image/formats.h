#pragma once

#include "stored.h"

namespace Stroma::Image
{
  // One reader a format. Each throws UserError with the true reason if the file is not whole, or cannot be read as it
  // is meant.

  /// NIfTI-1 and NIfTI-2, plain or gzip. Source of the layout: nifti1.h and nifti2.h of the NIfTI data format
  /// working group.
  Stored read_nifti(const std::string &path, const Selection &selection);

  /// NRRD with its voxels in the file or beside it, by the library NrrdIO. Source: Teem, "Definition of NRRD File
  /// Format".
  Stored read_nrrd(const std::string &path, const Selection &selection);

  /// MetaImage with its voxels in the file or in one beside it. Source: MetaIO documentation, "Reference: Tags".
  Stored read_metaimage(const std::string &path, const Selection &selection);

  /// TIFF and BigTIFF stacks, by the library libtiff. Source: TIFF revision 6.0 (Adobe 1992).
  Stored read_tiff(const std::string &path, const Selection &selection);
} // namespace Stroma::Image
