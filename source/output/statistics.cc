#include <stroma/output/statistics.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace Stroma::Output
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;
    using Samples = std::vector<std::pair<double, double>>;

    constexpr unsigned int  n_bins   = 8192;
    constexpr std::uint64_t n_gather = 4096;  // so few candidates are sorted at once
    constexpr double        slack    = 1e-12; // of the total weight, for rounding

    /// Range, number and weight of a sample over all ranks.
    struct SampleExtent
    {
      double        low, high, weight;
      std::uint64_t n;
    };

    /// @param for_each visits (value, weight)
    template <typename ForEach>
    SampleExtent
    extent(const ForEach &for_each, const MPI_Comm comm)
    {
      std::uint64_t n   = 0;
      double        low = std::numeric_limits<double>::infinity(), high = -low, weight = 0.;
      for_each([&](const double value, const double w) {
        low  = std::min(low, value);
        high = std::max(high, value);
        weight += w;
        ++n;
      });
      return {MPI::min(low, comm), MPI::max(high, comm), MPI::sum(weight, comm), MPI::sum(n, comm)};
    }

    unsigned int
    bin_of(const double value, const SampleExtent &range)
    {
      const double fraction = (value - range.low) / (range.high - range.low);
      return std::min(static_cast<unsigned int>(fraction * n_bins), n_bins - 1);
    }

    template <typename ForEach>
    std::vector<double>
    histogram(const ForEach &for_each, const SampleExtent &range, const MPI_Comm comm)
    {
      std::vector<double> weights(n_bins, 0.);
      for_each([&](const double value, const double weight) { weights[bin_of(value, range)] += weight; });
      MPI::sum(weights, comm, weights);
      return weights;
    }

    /// The bin in which the cumulated weight reaches @p target; @p below becomes the weight of the bins before it.
    unsigned int
    find_bin(const std::vector<double> &weights, const double target, double &below)
    {
      unsigned int last = 0;
      double       sum = below, before_last = below;
      for (unsigned int bin = 0; bin < n_bins; ++bin)
        {
          if (weights[bin] > 0.)
            {
              last        = bin;
              before_last = sum;
            }
          sum += weights[bin];
          if (weights[bin] > 0. && sum >= target)
            break;
        }
      below = before_last;
      return last;
    }

    template <typename ForEach>
    Samples
    samples_in_bin(const ForEach &for_each, const SampleExtent &range, const unsigned int bin)
    {
      Samples chosen;
      for_each([&](const double value, const double weight) {
        if (bin_of(value, range) == bin)
          chosen.emplace_back(value, weight);
      });
      return chosen;
    }

    double
    sorted_quantile(const Samples &samples, const double target, const double below, const MPI_Comm comm)
    {
      std::vector<double> numbers; // value and weight in turn
      for (const auto &[value, weight] : samples)
        numbers.insert(numbers.end(), {value, weight});
      Samples all;
      for (const std::vector<double> &part : MPI::all_gather(comm, numbers))
        for (std::size_t i = 0; i < part.size(); i += 2)
          all.emplace_back(part[i], part[i + 1]);
      std::sort(all.begin(), all.end());
      double sum = below;
      for (const auto &[value, weight] : all)
        if ((sum += weight) >= target)
          return value;
      return all.back().first;
    }

    /// Quantile among candidates, of which all smaller values together weigh @p below.
    double
    refine(Samples candidates, const double target, double below, const MPI_Comm comm)
    {
      const auto for_each = [&](const auto &visit) {
        for (const auto &[value, weight] : candidates)
          visit(value, weight);
      };
      while (true)
        {
          const SampleExtent range = extent(for_each, comm);
          if (range.low == range.high)
            return range.low;
          if (range.n <= n_gather)
            return sorted_quantile(candidates, target, below, comm);
          const unsigned int bin = find_bin(histogram(for_each, range, comm), target, below);
          candidates             = samples_in_bin(for_each, range, bin);
        }
    }
  } // namespace

  void
  VolumeWeightedQuantiles::reserve(const std::size_t n)
  {
    values.reserve(n);
  }

  void
  VolumeWeightedQuantiles::add(const double value, const double weight)
  {
    Assert(std::isfinite(value) && weight >= 0., dealii::ExcMessage("finite values, weights >= 0"));
    values.push_back(value);
    if (weights.empty() || weights.back().first != weight)
      weights.emplace_back(weight, 0);
    ++weights.back().second;
  }

  template <typename Visit>
  void
  VolumeWeightedQuantiles::for_each(const Visit &visit) const
  {
    auto value = values.begin();
    for (const auto &[weight, n] : weights)
      for (std::size_t i = 0; i < n; ++i)
        visit(*value++, weight);
  }

  std::vector<double>
  VolumeWeightedQuantiles::quantiles(const std::vector<double> &q, const MPI_Comm comm) const
  {
    const auto          all   = [&](const auto &visit) { for_each(visit); };
    const SampleExtent  range = extent(all, comm);
    std::vector<double> result(q.size(), range.n == 0 ? std::numeric_limits<double>::quiet_NaN() : range.low);
    if (range.n == 0 || range.low == range.high)
      return result;
    const std::vector<double> bins = histogram(all, range, comm);
    for (std::size_t i = 0; i < q.size(); ++i)
      {
        const double       target = std::max(q[i] - slack, std::numeric_limits<double>::min()) * range.weight;
        double             below  = 0.;
        const unsigned int bin    = find_bin(bins, target, below);
        result[i]                 = refine(samples_in_bin(all, range, bin), target, below, comm);
      }
    return result;
  }

  std::vector<double>
  VolumeWeightedQuantiles::shares(std::vector<double> &edges, const MPI_Comm comm) const
  {
    const auto         all   = [&](const auto &visit) { for_each(visit); };
    const SampleExtent range = extent(all, comm);
    if (range.n == 0 || !(range.weight > 0.))
      return {};
    std::vector<double> sums(edges.size() + 1);
    for_each([&](const double value, const double weight) {
      sums[std::upper_bound(edges.begin(), edges.end(), value) - edges.begin()] += weight / range.weight;
    });
    MPI::sum(sums, comm, sums);
    edges.insert(edges.begin(), std::min(range.low, edges.front()));
    edges.push_back(std::max(range.high, edges.back()));
    return sums;
  }

  double
  VolumeWeightedQuantiles::max(const MPI_Comm comm) const
  {
    double largest = -std::numeric_limits<double>::infinity();
    for (const double value : values)
      largest = std::max(largest, value);
    return MPI::max(largest, comm);
  }
} // namespace Stroma::Output
