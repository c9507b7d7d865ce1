#pragma once

#include <stroma/base/step_status.h>
#include <stroma/output/archive.h>
#include <stroma/output/state_view.h>
#include <stroma/output/summary.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace Stroma
{
  /// Work of one step, successful or not.
  struct StepWork
  {
    unsigned int newton_iterations = 0, linear_iterations = 0, residual_evaluations = 0;
    unsigned int hardest_solve =
      0; ///< Newton iterations of the hardest of the step's solves: what the next step goes by
    double longest_next =
      std::numeric_limits<double>::max(); ///< step that the method can take next, as far as it knows [s]
  };

  /// Names with unit and values.
  using Scalars = std::vector<std::pair<std::string, double>>;

  /// What is known of a method before it is set up.
  struct MethodFacts
  {
    std::vector<std::string> point_fields;   ///< that can be written, of Output::state_fields(), without unit
    std::vector<std::string> sampled_fields; ///< that are known at any place
    std::vector<std::string> image_fields;   ///< that sample points give for each voxel of the scene's only image
    std::vector<double>      times_to_meet;  ///< that a step must end at [s], besides the end

    /// Whether forces follow from rates or from the past, so that a displacement that jumps is felt by how fast it does.
    bool depends_on_rates = false;

    /// For methods that know the displacement gradient and the stress of their points.
    void
    add_deformation_fields()
    {
      const auto &names = Output::deformation_fields();
      point_fields.insert(point_fields.end(), names.begin(), names.end());
    }
  };

  /**
   * One way to solve a scene. Chosen once by name; called a few times a step, never per point. All functions are
   * collective. A method keeps a committed state (at the last accepted time) and never loses it.
   */
  class Method
  {
  public:
    virtual ~Method() = default;

    /// Makes grid, points, unknowns. Throws UserError for scenes that cannot be solved. Called by load_state()
    /// (saved_state.h), or at the start.
    /// @param archive state to continue from, of this time, or nullptr for the start
    virtual void setup(const Output::ArchiveReader *archive) = 0;

    /// One step from the committed state at @p t to @p t_next [s]. If the status is not ok the state is untouched.
    virtual StepStatus advance(double t, double t_next, StepWork &work) = 0;

    /// Fills in sizes, used and left-out parts, and results that only this method has.
    virtual void describe(Output::Summary &summary) = 0;

    /// Writes all that setup() needs to continue but time and scalars: nothing else goes from step to step, so that a run that
    /// is resumed repeats to the last digit one that never stopped.
    virtual void save(Output::ArchiveWriter &archive) const = 0;

    /// The committed state, to look at. @param with_gradients whether those of sample points will be asked for
    virtual std::unique_ptr<Output::StateView> state(bool with_gradients = true) = 0;

    /// Writes the committed state on the method's grid; returns the record's file name, or "" if there is nothing to write.
    virtual std::string write_grid(const Output::FieldRequest &request) = 0;

    MethodFacts facts;

    /// Of the committed state, set by advance() [s]. Saved and put back by saved_state.h, as the scalars are.
    double time = 0.;

    /// Reactions, energies and other numbers of the committed state, from setup() at the start and advance().
    Scalars scalars;

    /// Why the committed state is the last one that the scene has a meaning for; "": it is not. Set with the scalars.
    std::string ending;
  };
} // namespace Stroma
