#include <stroma/studies/region_sums.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Studies
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;

    void
    take_larger(Peak &peak, const double size, const double value, const Place &X)
    {
      if (size > std::abs(peak.value) || !peak.is_known)
        peak = {value, X, true};
    }

    Norm
    root_of_sum(const Norm &squares, const MPI_Comm comm)
    {
      return {std::sqrt(MPI::sum(squares.difference, comm)), std::sqrt(MPI::sum(squares.reference, comm))};
    }

    /// The largest of the ranks' peaks; of equal ones that of the lowest rank.
    Peak
    largest(const Peak &mine, const MPI_Comm comm)
    {
      Peak best;
      for (const auto &of_rank : MPI::all_gather(comm, std::vector<double>{mine.is_known ? 1. : 0., mine.value,
                                                                           mine.X[0], mine.X[1], mine.X[2]}))
        if (of_rank[0] > 0. && (!best.is_known || std::abs(of_rank[1]) > std::abs(best.value)))
          best = {of_rank[1], {{of_rank[2], of_rank[3], of_rank[4]}}, true};
      return best;
    }
  } // namespace

  RegionSums::RegionSums(const std::size_t n_regions)
    : sums(n_regions)
  {}

  void
  RegionSums::add(const FieldPair &field, const std::string &gradient, const Pairing &pairing, const Regions &regions)
  {
    const auto &samples   = pairing.places.samples;
    has_gradient          = pairing.has(gradient);
    const FieldPair slope = has_gradient ? pairing.pair(gradient) : FieldPair();
    for (std::size_t r = 0; r < regions.size(); ++r)
      {
        std::vector<std::size_t> places;
        for (const std::size_t i : pairing.covered)
          if (regions[r].second(samples.X[i], samples.material[i]))
            {
              places.push_back(i);
              sums[r].volume += samples.weight[i];
            }
        sums[r].n_places += places.size();
        sums[r].l2.add_squares(l2_norm(field, samples.weight, places));
        sums[r].max.take_larger(max_norm(field, places));
        if (has_gradient)
          sums[r].h1.add_squares(l2_norm(slope, samples.weight, places));
      }
    for (const std::size_t i : pairing.covered)
      {
        const bool   is_number = field.components == 1; // with its sign
        const double a = field.size_of_a(i), b = field.size_of_b(i);
        take_larger(peak_a, a, is_number ? field.a[i] : a, samples.X[i]);
        take_larger(peak_b, b, is_number ? field.b[i] : b, samples.X[i]);
      }
  }

  FieldComparison
  RegionSums::norms(const std::string &name, const double time, const Regions &regions,
                    const std::vector<std::string> &asked, const MPI_Comm comm) const
  {
    FieldComparison one{name, time, {}, largest(peak_a, comm), largest(peak_b, comm)};
    for (std::size_t r = 0; r < regions.size(); ++r)
      {
        RegionNorms norms;
        norms.region   = regions[r].first;
        norms.n_places = MPI::sum(sums[r].n_places, comm);
        norms.volume   = MPI::sum(sums[r].volume, comm);
        if (norms.n_places == 0 && std::count(asked.begin(), asked.end(), norms.region) > 0)
          throw UserError(
            "--region",
            "'" + norms.region +
              "' holds none of the places of comparison; its lengths are in m, enlarge it or move it into the bodies");
        norms.l2  = root_of_sum(sums[r].l2, comm);
        norms.h1  = has_gradient ? root_of_sum(sums[r].h1, comm) : Norm{unknown, unknown};
        norms.max = {MPI::max(sums[r].max.difference, comm), MPI::max(sums[r].max.reference, comm)};
        one.regions.push_back(norms);
      }
    return one;
  }
} // namespace Stroma::Studies
