#pragma once

#include <stroma/base/step_status.h>
#include <stroma/output/archive.h>
#include <stroma/output/point_writer.h>
#include <stroma/output/summary.h>

#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace Stroma
{
  /// Work of one step, successful or not.
  struct StepWork
  {
    unsigned int newton_iterations = 0, linear_iterations = 0, residual_evaluations = 0;
    unsigned int hardest_solve = 0; ///< Newton iterations of the hardest of the step's solves: what the next step goes by
    double       longest_next  = std::numeric_limits<double>::max(); ///< step that the method can take next, as far as it knows [s]
  };

  /// A field that can be evaluated at any place of the undeformed scene, for comparisons.
  struct SampledField
  {
    std::string  name; ///< with its unit, for example "displacement_m"
    unsigned int components;
  };

  /// Values of fields at places of the undeformed scene, the same on all ranks.
  struct Samples
  {
    std::vector<std::array<double, 3>> X;        ///< undeformed places [m], z = 0 in two dimensions
    std::vector<double>                weight;   ///< undeformed volume that each stands for [m^3]; may be empty
    std::vector<unsigned int>          material; ///< index into the scene's materials; may be empty
    std::vector<double>                values;   ///< all components of all asked fields of a place side by side
    std::vector<bool>                  found;    ///< whether the method has material there; empty: everywhere
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

    /// Writes all that setup() needs to continue: nothing else goes from step to step, so that a run that is resumed repeats to
    /// the last digit one that never stopped.
    virtual void save(Output::ArchiveWriter &archive) const = 0;

    /// Times that a step must end at [s], besides the end.
    virtual std::vector<double> times_to_meet() const = 0;

    /// Fields that sample() knows: displacement_m, displacement_gradient (row by row) and velocity_m_per_s where the
    /// method has them, von_mises_Pa, pressure_Pa, cauchy_stress_Pa (6, deal.II's order).
    virtual std::vector<SampledField> sampled_fields() const = 0;

    /// Evaluates the committed state at samples.X; fills values and found. Collective, with the same places on all ranks.
    virtual void sample(const std::vector<std::string> &fields, Samples &samples) = 0;

    /// The method's own points with their values: material points, particles or quadrature points. Collective.
    virtual Samples own_samples(const std::vector<std::string> &fields) = 0;

    /// Names of the point fields that write_fields() knows.
    virtual std::vector<std::string> known_point_fields() const = 0;
  };
} // namespace Stroma
