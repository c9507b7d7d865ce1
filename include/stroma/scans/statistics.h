#pragma once

#include <stroma/image/histogram.h>
#include <stroma/image/read.h>

#include <string>
#include <utility>
#include <vector>

namespace Stroma::Scans
{
  /// What the grey values of an image are.
  struct Statistics
  {
    double lowest = 0, highest = 0, mean = 0, deviation = 0; ///< deviation: standard, of all voxels
    /// Per cent and the value below which so many voxels lie.
    std::vector<std::pair<double, double>> percentiles;

    struct Suggestion
    {
      std::string name; ///< as in the entries of thresholds
      double      threshold = 0;
      double      share     = 0; ///< of the voxels, from the threshold on
    };
    std::vector<Suggestion> suggestions; ///< none for an image of one value
    Image::Histogram        histogram;
  };

  Statistics statistics_of(const std::vector<float> &values);
} // namespace Stroma::Scans
