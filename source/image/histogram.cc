#include <stroma/image/histogram.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Stroma::Image
{
  namespace
  {
    constexpr double      most_whole_numbers = 65536;
    constexpr std::size_t n_equal_bins       = 256;

    /// The value of rank @p rank among sorted whole numbers.
    double
    exact_value(const Histogram &histogram, const std::size_t rank)
    {
      std::size_t n = 0, bin = 0;
      while (n + histogram.count[bin] <= rank)
        n += histogram.count[bin++];
      return histogram.edge(bin);
    }
  } // namespace

  std::size_t
  Histogram::n_from(const double threshold) const
  {
    const double bin = std::ceil((threshold - lowest) / width - 1e-9);
    if (!(bin < count.size()))
      return 0;
    return std::accumulate(count.begin() + static_cast<std::ptrdiff_t>(std::max(bin, 0.)), count.end(), std::size_t(0));
  }

  Histogram
  histogram_of(const std::vector<float> &values)
  {
    const auto   ends   = std::minmax_element(values.begin(), values.end());
    const double lowest = *ends.first, span = double(*ends.second) - lowest;
    Histogram    histogram;
    histogram.lowest   = lowest;
    histogram.is_exact = span < most_whole_numbers && std::all_of(values.begin(), values.end(), [](const float value) {
                           return value == std::nearbyint(value);
                         });
    const std::size_t n_bins = histogram.is_exact ? static_cast<std::size_t>(span) + 1 : n_equal_bins;
    histogram.width          = histogram.is_exact ? 1. : span / n_bins;
    histogram.count.assign(n_bins, 0);
    for (const float value : values)
      ++histogram.count[std::min(static_cast<std::size_t>((value - lowest) / histogram.width), n_bins - 1)];
    return histogram;
  }

  std::vector<double>
  percentiles(const std::vector<float> &values, const Histogram &histogram, const std::vector<double> &shares)
  {
    std::vector<float> sorted;
    if (!histogram.is_exact)
      sorted = values;
    const auto value_of = [&](const std::size_t rank) -> double {
      if (histogram.is_exact)
        return exact_value(histogram, rank);
      std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
      return sorted[rank];
    };
    std::vector<double> found;
    for (const double share : shares)
      {
        const double      place = share / 100 * (values.size() - 1);
        const std::size_t rank  = static_cast<std::size_t>(place);
        const double      rest = place - rank, value = value_of(rank);
        found.push_back(rest == 0 ? value : value + rest * (value_of(rank + 1) - value));
      }
    return found;
  }
} // namespace Stroma::Image
