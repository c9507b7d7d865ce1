#pragma once

#include <stroma/output/file_units.h>
#include <stroma/output/point_state.h>

#include <string>
#include <vector>

namespace Stroma::Output
{
  /// A field as files and comparisons have it.
  struct Field
  {
    std::string  name;       ///< with its unit, for example "von_mises_Pa"
    unsigned int components; ///< 1 scalar; dim or 3 vector or principal values; 6 symmetric tensor (deal.II's order
                             ///< 00 11 22 01 02 12); 4 or 9 tensor row by row
  };

  /// A field that is found from the state of a point.
  struct StateField
  {
    std::string name, unit;
    std::vector<std::string> (*components)(
      unsigned int dim); ///< their names: {""} for a scalar, {"x", "y"}, {"xx", ...}
    void (*fill)(const PointState &, unsigned int dim, double *);
    bool needs_gradients = false; ///< those of the displacement or velocity

    /// With its unit, for example "displacement_m".
    std::string
    full_name() const
    {
      return name + (unit.empty() ? "" : "_" + unit);
    }
  };

  /// All fields of points, of any method; each method says which of them it knows. A new field is a line here.
  const std::vector<StateField> &state_fields();

  /// Names of the fields that follow from the deformation gradient F = 1 + grad u of a solid and its Cauchy stress:
  /// principal stresses, principal stretches, Green-Lagrange and Almansi strain, first Piola-Kirchhoff stress.
  const std::vector<std::string> &deformation_fields();

  /// Some of them, for a scene of @p dim dimensions: their values lie side by side.
  class StateFields
  {
  public:
    /// @param names with or without unit, each one of state_fields(); the order counts
    StateFields(unsigned int dim, const std::vector<std::string> &names);

    /// The names that @p names holds, in the order of state_fields().
    static std::vector<std::string> in_order(const std::vector<std::string> &names);

    unsigned int
    width() const
    {
      return n_values;
    } ///< numbers of a point
    bool               has_gradients() const;
    std::vector<Field> list(const FileUnits &units = {}) const; ///< as files in these units have them

    /// Of each number of a point: the name, component and unit of what it is, as {"cauchy_stress", "xx", "Pa"}.
    struct Number
    {
      std::string field, component, unit;

      /// "cauchy_stress_xx"; with @p statistic "cauchy_stress_xx_mean".
      std::string stem(const std::string &statistic = "") const;

      /// That with its unit: "cauchy_stress_xx_mean_Pa".
      std::string name(const std::string &statistic = "") const;
    };
    std::vector<Number> numbers() const;

    /// What each number of a point is multiplied by for a file in these units.
    std::vector<double> factors(const FileUnits &units) const;

    /// All values of @p state.
    void fill(const PointState &state, double *values) const;

  private:
    unsigned int                    dim, n_values = 0;
    std::vector<const StateField *> chosen;
    std::vector<unsigned int>       sizes; ///< numbers of each
  };
} // namespace Stroma::Output
