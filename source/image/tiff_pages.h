#pragma once

#include "stored.h"

namespace Stroma::Image
{
  /// What the pages of a TIFF stack are: slices of how many channels and frames.
  struct TiffPages
  {
    std::size_t n_slices = 1, n_channels = 1, n_frames = 1;
    /// Page of each plane, slices fastest, then channels, then frames.
    std::vector<std::size_t> page;
    /// The file has one directory, and the pixels of the planes that it does not name follow those of the first.
    bool one_directory = false;

    /// Pages of the slices of one channel and frame.
    std::vector<std::size_t> slices(std::size_t channel, std::size_t frame) const;
  };

  /**
   * What the description in the first page of a TIFF with `n_pages` directories says: that of ImageJ (lines
   * "slices=..."), OME (XML, any order of dimensions) or tifffile ({"shape": ...}); other stacks are slices only.
   * Sources: ImageJ's TiffEncoder; OME data model 2016-06, "TiffData"; tifffile, "TiffWriter.write".
   * Throws UserError naming `path` if it speaks of other pages than the file has.
   */
  TiffPages tiff_pages(const std::string &path, const std::string &description, std::size_t n_pages);
} // namespace Stroma::Image
