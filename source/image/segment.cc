#include <stroma/base/counted.h>
#include <stroma/image/segment.h>

#include "words.h"

#include <stroma/image/automatic_threshold.h>
#include <stroma/image/hysteresis.h>
#include <stroma/image/pieces.h>
#include <stroma/image/smooth.h>

#include <algorithm>
#include <optional>

namespace Stroma::Image
{
  namespace
  {
    std::string
    in_words(const Threshold &threshold, const double value)
    {
      switch (threshold.kind)
        {
          case Threshold::Kind::otsu:
            return number(value) + " (Otsu)";
          case Threshold::Kind::triangle:
            return number(value) + " (triangle)";
          case Threshold::Kind::percentile:
            return number(value) + " (percentile " + number(threshold.value) + ")";
          default:
            return number(value);
        }
    }

    /// Grey values of thresholds, from one histogram.
    class Chooser
    {
    public:
      explicit Chooser(const std::vector<float> &values)
        : values(values)
      {}

      double
      value_of(const Threshold &threshold)
      {
        if (threshold.kind == Threshold::Kind::given)
          return threshold.value;
        if (!histogram)
          histogram = histogram_of(values);
        if (threshold.kind == Threshold::Kind::percentile)
          return percentiles(values, *histogram, {threshold.value}).front();
        return automatic_threshold(*histogram, threshold.kind == Threshold::Kind::otsu ? AutomaticThreshold::otsu :
                                                                                         AutomaticThreshold::triangle);
      }

    private:
      const std::vector<float> &values;
      std::optional<Histogram>  histogram;
    };

    void
    leave_out_pieces(const SegmentSettings &settings, Segmented &result)
    {
      if (settings.smallest_piece <= 1 && !settings.largest_only)
        return;
      const auto  pieces = find_pieces(result.mask, settings.connectivity);
      std::size_t n_kept = 0, n_left_out = 0;
      for (const std::size_t size : pieces.size)
        if (size >= settings.smallest_piece && (n_kept == 0 || !settings.largest_only))
          ++n_kept;
        else
          n_left_out += size;
      for (std::size_t i = 0; i < result.mask.data.size(); ++i)
        if (pieces.number.data[i] > n_kept)
          result.mask.data[i] = 0;
      result.n_largest = pieces.size.empty() ? 0 : pieces.size.front();
      result.remarks.push_back(std::to_string(pieces.size.size() - n_kept) + " of " +
                               counted(pieces.size.size(), "piece") + " left out (" + counted(n_left_out, "voxel") +
                               ")");
    }

    Volume<float>
    smoothed(const Volume<float> &image, const SegmentSettings &settings)
    {
      return settings.smoothing == Smoothing::median ? median(image, settings.median_radius) :
                                                       gaussian(image, settings.deviation);
    }
  } // namespace

  Segmented
  segment(const Volume<float> &image, const SegmentSettings &settings)
  {
    Segmented     result;
    Volume<float> smooth;
    if (settings.smoothing != Smoothing::none)
      {
        smooth = smoothed(image, settings);
        result.remarks.push_back(settings.smoothing == Smoothing::median ? "smoothed by a median" :
                                                                           "smoothed by a Gaussian");
      }
    const Volume<float> &grey = settings.smoothing == Smoothing::none ? image : smooth;
    const auto           ends = std::minmax_element(grey.data.begin(), grey.data.end());
    result.lowest             = *ends.first;
    result.highest            = *ends.second;
    Chooser chooser(grey.data);
    result.lower = chooser.value_of(settings.lower);
    result.upper = chooser.value_of(settings.upper);
    result.mask  = hysteresis_threshold(grey, result.lower, result.upper, settings.connectivity);
    result.remarks.push_back("thresholds " + in_words(settings.lower, result.lower) + " and " +
                             in_words(settings.upper, result.upper));
    if (settings.closing_radius > 0)
      {
        close_gaps(result.mask, settings.closing_radius);
        result.remarks.push_back("closed by " + number(settings.closing_radius * 1e6) + " um");
      }
    leave_out_pieces(settings, result);
    return result;
  }
} // namespace Stroma::Image
