#include <stroma/output/point_results.h>
#include <stroma/output/text_file.h>
#include <stroma/solid/stress_measures.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Output
{
  /// Sums and quantiles of some groups.
  class GroupStatistics
  {
  public:
    GroupStatistics(const PointGroups &groups, const unsigned int dim)
      : groups(groups)
      , fields(dim, groups.fields)
      , values(fields.width())
      , volume(groups.names.size())
      , von_mises(groups.names.size())
      , sums(groups.names.size() * fields.width())
      , samples(sums.size())
    {}

    void
    add(const PointState &point, const double mises)
    {
      const unsigned int group = groups.group_of(point);
      if (group >= volume.size())
        return;
      volume[group] += point.V0;
      von_mises[group] += point.V0 * mises;
      fields.fill(point, values.data());
      for (unsigned int k = 0; k < values.size(); ++k)
        {
          sums[group * values.size() + k] += point.V0 * values[k];
          samples[group * values.size() + k].add(values[k], point.V0);
        }
    }

    /// @param whole volume of all points [m^3]
    void
    report(const double whole, const MPI_Comm comm, std::map<std::string, double> &results) const
    {
      const auto sum = [comm](std::vector<double> of_rank) {
        dealii::Utilities::MPI::sum(of_rank, comm, of_rank);
        return of_rank;
      };
      const auto volume = sum(this->volume), von_mises = sum(this->von_mises), sums = sum(this->sums);
      for (unsigned int g = 0; g < volume.size(); ++g)
        {
          const std::string &name           = groups.names[g];
          results["volume_" + name + "_m3"] = volume[g];
          results["fraction_" + name]       = volume[g] / whole;
          if (volume[g] == 0.)
            continue;
          results["von_mises_mean_" + name + "_Pa"] = von_mises[g] / volume[g];
          const auto numbers                        = fields.numbers();
          for (unsigned int k = 0; k < numbers.size(); ++k)
            {
              const unsigned int i                     = g * numbers.size() + k;
              const auto         quantiles             = samples[i].quantiles({.01, .5, .99}, comm);
              results[numbers[k].name("mean_" + name)] = sums[i] / volume[g];
              results[numbers[k].name("p01_" + name)]  = quantiles[0];
              results[numbers[k].name("p50_" + name)]  = quantiles[1];
              results[numbers[k].name("p99_" + name)]  = quantiles[2];
            }
        }
    }

    void
    add_histograms(const MPI_Comm comm, std::vector<Histogram> &list) const
    {
      const auto   numbers  = fields.numbers();
      const auto   n_groups = static_cast<unsigned int>(groups.names.size());
      const double infinity = std::numeric_limits<double>::infinity();
      for (unsigned int k = 0; k < numbers.size(); ++k)
        {
          double low = infinity, high = -infinity;
          for (unsigned int g = 0; g < n_groups; ++g)
            {
              const auto ends = samples[g * numbers.size() + k].quantiles({.001, .999}, comm);
              low             = std::fmin(low, ends[0]); // an empty group has none
              high            = std::fmax(high, ends[1]);
            }
          for (unsigned int g = 0; g < n_groups; ++g)
            {
              Histogram          one{groups.names[g], numbers[k].stem(), numbers[k].unit, {}, {}};
              const unsigned int n = high > low ? n_inner_bins : 1;
              for (unsigned int b = 0; b <= n; ++b)
                one.edges.push_back(low + b * (high - low) / n);
              one.fractions = samples[g * numbers.size() + k].shares(one.edges, comm);
              if (!one.fractions.empty())
                list.push_back(one);
            }
        }
    }

  private:
    static constexpr unsigned int n_inner_bins = 48;

    const PointGroups                   &groups;
    StateFields                          fields;
    std::vector<double>                  values; ///< of a point
    std::vector<double>                  volume, von_mises, sums;
    std::vector<VolumeWeightedQuantiles> samples;
  };

  namespace
  {
    void
    add_von_mises(const VolumeWeightedQuantiles &stresses, const MPI_Comm comm, std::map<std::string, double> &results)
    {
      const auto found             = stresses.quantiles({.5, .99, .999}, comm);
      results["max_von_mises_Pa"]  = stresses.max(comm);
      results["von_mises_p50_Pa"]  = found[0];
      results["von_mises_p99_Pa"]  = found[1];
      results["von_mises_p999_Pa"] = found[2];
    }
  } // namespace

  bool
  PointRequest::has_gradients() const
  {
    return std::any_of(groups.begin(), groups.end(),
                       [&](const auto &group) { return StateFields(dim, group.fields).has_gradients(); });
  }

  PointResults::PointResults(const PointRequest &request, const std::size_t n_points)
    : request(request)
  {
    stresses.reserve(n_points);
    for (const auto &group : this->request.groups)
      groups.emplace_back(group, request.dim);
  }

  PointResults::~PointResults() = default;

  void
  PointResults::add(const PointState &point)
  {
    if (point.is_fixed)
      return;
    const double mises = Solid::von_mises(point.cauchy);
    stresses.add(mises, point.V0);
    volume += point.V0;
    displacement = std::max(displacement, point.u.norm());
    speed        = std::max(speed, point.v.norm());
    for (auto &group : groups)
      group.add(point, mises);
  }

  void
  PointResults::report(const MPI_Comm comm, std::map<std::string, double> &results) const
  {
    add_von_mises(stresses, comm, results);
    if (request.displacement)
      results.try_emplace("max_displacement_m", dealii::Utilities::MPI::max(displacement, comm));
    if (request.velocity)
      results.try_emplace("max_speed_m_per_s", dealii::Utilities::MPI::max(speed, comm));
    const double whole = dealii::Utilities::MPI::sum(volume, comm);
    for (const auto &group : groups)
      group.report(whole, comm, results);
  }

  std::vector<Histogram>
  PointResults::histograms(const MPI_Comm comm) const
  {
    std::vector<Histogram> list;
    for (const auto &group : groups)
      group.add_histograms(comm, list);
    return list;
  }

  std::string
  histogram_table(const std::vector<Histogram> &histograms)
  {
    std::string text = "group,field,unit,from,to,fraction\n";
    for (const auto &one : histograms)
      for (unsigned int b = 0; b < one.fractions.size(); ++b)
        text += csv_cell(one.group) + "," + one.field + "," + one.unit + "," + to_text(one.edges[b]) + "," +
                to_text(one.edges[b + 1]) + "," + to_text(one.fractions[b]) + "\n";
    return text;
  }

  std::unique_ptr<PointResults>
  add_point_results(const StateView &state, const PointRequest &request, const MPI_Comm comm,
                    std::map<std::string, double> &results)
  {
    auto of_points = std::make_unique<PointResults>(request, state.n_points());
    state.for_each_point([&](const PointState &point) { of_points->add(point); });
    of_points->report(comm, results);
    return of_points;
  }
} // namespace Stroma::Output
