#pragma once

#include <stroma/output/state_view.h>
#include <stroma/output/statistics.h>

#include <deal.II/base/mpi.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace Stroma::Output
{
  /// The sample points in groups, for example by material, and what is told of each group.
  struct PointGroups
  {
    std::vector<std::string>                        names;    ///< as results carry them
    std::function<unsigned int(const PointState &)> group_of; ///< names.size() for a point of none
    std::vector<std::string>                        fields;   ///< whose mean and quantiles are wanted, without unit
  };

  /// What is told of the sample points of a state.
  struct PointRequest
  {
    unsigned int             dim          = 3;
    bool                     displacement = false; ///< whether points have one that is known
    bool                     velocity     = false;
    std::vector<PointGroups> groups;

    bool has_gradients() const; ///< whether those of the points are needed
  };

  class GroupStatistics;

  /// How one number of a field is distributed in one group.
  struct Histogram
  {
    std::string         group, field, unit; ///< "vessel", "principal_stress_1", "Pa"
    std::vector<double> edges;     ///< of the bins; the first is the lowest value there is, the last the highest
    std::vector<double> fractions; ///< of the group's undeformed volume, in each bin
  };

  /// A line a bin, as comma-separated values: group, field, unit, from, to, fraction.
  std::string histogram_table(const std::vector<Histogram> &histograms);

  /**
   * Numbers of all sample points, weighted by undeformed volume, of which each rank is shown its own:
   *   max_von_mises_Pa, von_mises_p50_Pa, _p99_, _p999_   largest von Mises stress and quantiles
   *   max_displacement_m, max_speed_m_per_s               unless @p results has them
   *   volume_NAME_m3, fraction_NAME, von_mises_mean_NAME_Pa   of each group; the part of the volume of all points
   *   FIELD_mean_NAME_UNIT, _p01_, _p50_, _p99_           of each group and each number of its fields
   * A group without points has volume 0 and nothing else. Particles of walls do not count.
   */
  class PointResults
  {
  public:
    /// @param n_points that are expected on this rank
    PointResults(const PointRequest &request, std::size_t n_points);
    ~PointResults();

    void add(const PointState &point);

    /// Collective.
    void report(MPI_Comm comm, std::map<std::string, double> &results) const;

    /// Of each group and each number of its fields. A field has the same bins in all groups of a kind: 48 of equal width
    /// from the lowest 1 in 1000 of a group to the highest, and one for the rest at each end. Collective.
    std::vector<Histogram> histograms(MPI_Comm comm) const;

  private:
    const PointRequest           request;
    VolumeWeightedQuantiles      stresses;
    std::vector<GroupStatistics> groups;
    double                       volume = 0., displacement = 0., speed = 0.;
  };

  /// Adds what is told of all points of @p state to @p results, and returns it. Collective.
  std::unique_ptr<PointResults> add_point_results(const StateView &state, const PointRequest &request, MPI_Comm comm,
                                                  std::map<std::string, double> &results);
} // namespace Stroma::Output
