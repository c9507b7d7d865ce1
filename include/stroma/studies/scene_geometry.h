#pragma once

#include <stroma/output/point_state.h>
#include <stroma/simulation/saved_run.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Stroma::Studies
{
  using Output::Place; // undeformed

  /// By what two scenes are told apart.
  struct SceneFrame
  {
    std::string              title;
    unsigned int             dimension = 0;
    Place                    lower{}, upper{}; ///< around the bodies that are not rigid [m]
    std::vector<std::string> materials;
    double                   thickness = 1.; ///< of a plane scene [m]

    /// In words, what differs from @p other ("has dimension 3 instead of 2"), or "". Corners count as equal within 1e-6
    /// of the box's largest edge.
    std::string difference_from(const SceneFrame &other) const;
  };

  /// The bodies of a scene, whatever its dimension. Local to the rank, the same on all ranks.
  class SceneGeometry
  {
  public:
    /// Whether a place with material of this index belongs.
    using Region = std::function<bool(const Place &, unsigned int)>;

    /// That of a run's scene; the run must outlive it.
    static std::unique_ptr<SceneGeometry> of(const SavedRun &run);

    virtual ~SceneGeometry() = default;

    /// Index of the material at a place, if there is any.
    virtual std::optional<unsigned int> material_at(const Place &X) const = 0;

    /// A region in the words of 'Where' (see Region), lengths in m. Throws UserError, also for those that are no material.
    virtual Region region(const std::string &text) const = 0;

    SceneFrame frame;
  };
} // namespace Stroma::Studies
