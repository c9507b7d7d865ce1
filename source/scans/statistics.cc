#include <stroma/image/automatic_threshold.h>
#include <stroma/scans/statistics.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Scans
{
  Statistics
  statistics_of(const std::vector<float> &values)
  {
    using Image::AutomaticThreshold;
    Statistics statistics;
    const auto ends      = std::minmax_element(values.begin(), values.end());
    statistics.lowest    = *ends.first;
    statistics.highest   = *ends.second;
    statistics.histogram = Image::histogram_of(values);
    double sum = 0, squares = 0;
    for (const double value : values)
      sum += value;
    statistics.mean = sum / values.size();
    for (const double value : values)
      squares += (value - statistics.mean) * (value - statistics.mean);
    statistics.deviation             = std::sqrt(squares / values.size());
    const std::vector<double> shares = {.5, 1, 5, 25, 50, 75, 95, 99, 99.5};
    const auto                found  = Image::percentiles(values, statistics.histogram, shares);
    for (std::size_t i = 0; i < shares.size(); ++i)
      statistics.percentiles.emplace_back(shares[i], found[i]);
    if (statistics.lowest == statistics.highest)
      return statistics;
    for (const auto &[name, method] :
         {std::make_pair("Otsu", AutomaticThreshold::otsu), std::make_pair("triangle", AutomaticThreshold::triangle)})
      {
        const double threshold = Image::automatic_threshold(statistics.histogram, method);
        statistics.suggestions.push_back(
          {name, threshold, double(statistics.histogram.n_from(threshold)) / values.size()});
      }
    return statistics;
  }
} // namespace Stroma::Scans
