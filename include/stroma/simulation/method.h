#pragma once

#include <stroma/base/step_status.h>
#include <stroma/output/archive.h>
#include <stroma/output/point_writer.h>
#include <stroma/output/summary.h>

#include <string>
#include <utility>
#include <vector>

namespace Stroma
{
  /// Work of one step, successful or not.
  struct StepWork
  {
    unsigned int newton_iterations = 0, linear_iterations = 0, residual_evaluations = 0;
  };

  /// What fields to write, and where.
  struct FieldRequest
  {
    std::string              folder;
    unsigned int             counter;
    std::vector<std::string> point_fields; ///< names without unit
    bool                     grid_fields;
    Output::Format           format;
  };

  /**
   * One way to solve a scene. Chosen once by name; called a few times a step, never per point. All functions are
   * collective. A method keeps a committed state (at the last accepted time) and never loses it.
   */
  class Method
  {
  public:
    virtual ~Method() = default;

    /// Makes grid, points, unknowns. Throws UserError for scenes that cannot be solved.
    /// @param archive state to continue from, or nullptr for the start
    virtual void setup(const Output::ArchiveReader *archive) = 0;

    /// One step from the committed state at @p t to @p t_next [s]. If the status is not ok the state is untouched.
    virtual StepStatus advance(double t, double t_next, StepWork &work) = 0;

    /// Numbers that describe the committed state (name with unit, value): reactions, energies.
    virtual std::vector<std::pair<std::string, double>> scalars() const = 0;

    /// Writes the committed state's fields; returns (series, record) pairs such as ("points", "points_0003.pvtu").
    virtual std::vector<std::pair<std::string, std::string>> write_fields(const FieldRequest &request) = 0;

    /// Fills in sizes, used and left-out parts, and the final results.
    virtual void describe(Output::Summary &summary) = 0;

    /// Writes all that setup() needs to continue, and makes this run continue in just the same way.
    virtual void save(Output::ArchiveWriter &archive) = 0;

    /// Times that a step must end at [s], besides the end.
    virtual std::vector<double> times_to_meet() const = 0;

    /// Names of the point fields that write_fields() knows.
    virtual std::vector<std::string> known_point_fields() const = 0;
  };
} // namespace Stroma
