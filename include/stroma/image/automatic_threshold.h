#pragma once

#include <stroma/image/histogram.h>

namespace Stroma::Image
{
  enum class AutomaticThreshold
  {
    otsu,    ///< largest variance between the two classes (Otsu 1979)
    triangle ///< farthest from the line between the mode and the 1st or 99th percentile (Zack et al. 1977, as in ITK)
  };

  /**
   * The lowest grey value of the upper of the two classes that the histogram falls into: an edge of its bins. For exact
   * histograms Otsu's is the highest value of the lower class plus one.
   * Throws UserError for an image of one value.
   */
  double automatic_threshold(const Histogram &histogram, AutomaticThreshold method);
} // namespace Stroma::Image
