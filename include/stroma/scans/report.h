#pragma once

#include <stroma/scans/segmentation.h>
#include <stroma/scans/statistics.h>

#include <optional>
#include <string>

namespace Stroma::Scans
{
  /// All that is said of an image.
  struct Report
  {
    std::string                 file, type;
    std::array<unsigned int, 3> size;
    std::array<double, 3>       voxel_size; ///< [m]
    std::vector<std::string>    remarks;    ///< of the reader
    Statistics                  statistics;
    std::string                 scene; ///< file of the scene that segments it, if one does
    std::optional<Segmentation> segmentation;
    std::string                 written; ///< file of the segmentation
  };

  /// For people.
  std::string text_of(const Report &report);

  /// Numbers with their units, lengths in m.
  std::string json_of(const Report &report);

  /// Edges and counts of at most 512 bins, wider ones than the report's where it has more.
  std::string histogram_table(const Image::Histogram &histogram);

  /// A row for each connected piece of each material.
  std::string pieces_table(const Segmentation &segmentation);
} // namespace Stroma::Scans
