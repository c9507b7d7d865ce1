#pragma once

#include <stroma/output/state_view.h>
#include <stroma/output/statistics.h>

#include <deal.II/base/mpi.h>

#include <functional>
#include <map>
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

  private:
    const PointRequest           request;
    VolumeWeightedQuantiles      stresses;
    std::vector<GroupStatistics> groups;
    double                       volume = 0., displacement = 0., speed = 0.;
  };

  /// PointResults of all points of @p state. Collective.
  void add_point_results(const StateView &state, const PointRequest &request, MPI_Comm comm,
                         std::map<std::string, double> &results);
} // namespace Stroma::Output
