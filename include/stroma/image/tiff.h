#pragma once

#include <string>

namespace Stroma::Image
{
  /**
   * Check that a TIFF file is a stack of complete grey pages that the reader gets right, and return the number of
   * pages. ITK alone would take a file that was cut off for a shorter stack and read past its buffer when pages differ.
   * Source of the layout: TIFF revision 6.0 (Adobe 1992), and BigTIFF.
   *
   * Throws UserError, naming the file, when it is no TIFF or is cut off, when pages differ in size, are reduced copies
   * or masks, are stored in tiles, in colour or with other than 8 or 16 bits a voxel.
   */
  unsigned int check_tiff(const std::string &path);
} // namespace Stroma::Image
