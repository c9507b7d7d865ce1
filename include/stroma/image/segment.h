#pragma once

#include <stroma/image/connectivity.h>
#include <stroma/image/volume.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace Stroma::Image
{
  /// A grey value, given or found from the image.
  struct Threshold
  {
    enum class Kind
    {
      given,
      otsu,
      triangle,
      percentile
    };
    Kind   kind  = Kind::given;
    double value = std::numeric_limits<double>::quiet_NaN(); ///< given: the grey value; percentile: per cent below it
  };

  enum class Smoothing
  {
    none,
    median,
    gaussian
  };

  /// How grey values become a structure (1) and what is round it (0), in this order.
  struct SegmentSettings
  {
    Smoothing                   smoothing     = Smoothing::none;
    std::array<unsigned int, 3> median_radius = {{1, 1, 1}}; ///< voxels
    double                      deviation     = 0;           ///< of the Gaussian [m]
    Threshold                   lower, upper;
    Connectivity                connectivity   = Connectivity::faces;
    double                      closing_radius = 0;     ///< [m]; 0: none
    unsigned int                smallest_piece = 0;     ///< pieces of fewer voxels are left out
    bool                        largest_only   = false; ///< only the largest piece is kept
  };

  struct Segmented
  {
    Volume<std::uint8_t>     mask;
    double                   lower = 0, upper = 0;    ///< the thresholds used
    double                   lowest = 0, highest = 0; ///< grey values that they divided
    std::size_t              n_largest = 0;           ///< voxels of the largest piece, where pieces were left out
    std::vector<std::string> remarks;                 ///< what was done, for people
  };

  /**
   * The structure that an image shows: smoothed, thresholded (hysteresis_threshold), closed, and cleaned of small pieces.
   * Automatic thresholds are those of the smoothed image. Throws UserError for settings that the image does not allow.
   */
  Segmented segment(const Volume<float> &image, const SegmentSettings &settings);
} // namespace Stroma::Image
