#pragma once

#include <cstddef>
#include <vector>

namespace Stroma::Image
{
  /// How often grey values occur: bin k counts the values from edge(k) on and below edge(k + 1).
  struct Histogram
  {
    double                   lowest = 0, width = 1;
    std::vector<std::size_t> count;
    /// Each bin stands for one whole number.
    bool is_exact = true;

    double
    edge(const std::size_t bin) const
    {
      return lowest + bin * width;
    }

    /// Number of values from @p threshold on. Exact at the edges of bins.
    std::size_t n_from(double threshold) const;
  };

  /// Whole numbers that span at most 65536 have a bin each, other values 256 bins of equal width.
  Histogram histogram_of(const std::vector<float> &values);

  /**
   * The values below which @p shares per cent of all lie, interpolated between the sorted values (definition 7 of Hyndman
   * and Fan 1996, which numpy and R take too).
   * @param histogram of the same values
   */
  std::vector<double> percentiles(const std::vector<float> &values, const Histogram &histogram,
                                  const std::vector<double> &shares);
} // namespace Stroma::Image
