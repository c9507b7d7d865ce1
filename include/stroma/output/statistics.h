#pragma once

#include <deal.II/base/mpi.h>

#include <utility>
#include <vector>

namespace Stroma::Output
{
  /**
   * Quantiles of a distributed sample with weights, for example of stress weighted by volume. The quantile q is the
   * smallest value v such that the values <= v carry at least q of the total weight (within 1e-12 of it). Found by
   * histograms that are refined around each quantile; no rank ever sees the whole sample. 8 bytes a value, and 16 wherever
   * the weight is another than before.
   */
  class VolumeWeightedQuantiles
  {
  public:
    /// Room for @p n values of this rank.
    void reserve(std::size_t n);

    /// Local to the rank. @param value finite @param weight not negative
    void add(double value, double weight);

    /// Exact for each of @p q in [0, 1], in their order; not a number if there are no values. Collective.
    std::vector<double> quantiles(const std::vector<double> &q, MPI_Comm comm) const;

    /// The part of the weight between each two of @p edges (the upper one apart), and below and above them all: @p edges then
    /// begins with the smallest value, or the first edge if that is less, and ends alike. Empty without values. Collective.
    std::vector<double> shares(std::vector<double> &edges, MPI_Comm comm) const;

    /// Largest value on all ranks; minus infinity if there is none. Collective.
    double max(MPI_Comm comm) const;

  private:
    template <typename Visit>
    void for_each(const Visit &visit) const;

    std::vector<double>                         values;
    std::vector<std::pair<double, std::size_t>> weights; ///< (weight, number of values in turn that have it)
  };
} // namespace Stroma::Output
