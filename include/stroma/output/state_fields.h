#pragma once

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <string>
#include <vector>

namespace Stroma::Output
{
  /// A field of points that is found from the state of one.
  template <typename State>
  struct StateField
  {
    std::string  name, unit;
    unsigned int components;
    void (*fill)(const State &, double *);

    /// With its unit, for example "displacement_m".
    std::string full_name() const { return name + (unit.empty() ? "" : "_" + unit); }
  };

  template <typename State>
  unsigned int
  n_components(const std::vector<StateField<State>> &fields)
  {
    unsigned int n = 0;
    for (const auto &field : fields)
      n += field.components;
    return n;
  }

  /// All values of @p fields side by side.
  template <typename State>
  void
  fill(const std::vector<StateField<State>> &fields, const State &state, double *values)
  {
    for (const auto &field : fields)
    {
      field.fill(state, values);
      values += field.components;
    }
  }

  /// Those of @p table that @p names holds, in the order of the table.
  template <typename State>
  std::vector<StateField<State>>
  named(const std::vector<StateField<State>> &table, const std::vector<std::string> &names)
  {
    std::vector<StateField<State>> chosen;
    std::copy_if(table.begin(), table.end(), std::back_inserter(chosen), [&](const auto &field) {
      return std::find(names.begin(), names.end(), field.name) != names.end();
    });
    return chosen;
  }

  /// Entries of @p table by their full names, in the order of @p full_names; each must be there.
  template <typename State>
  std::vector<StateField<State>>
  with_full_names(const std::vector<StateField<State>> &table, const std::vector<std::string> &full_names)
  {
    std::vector<StateField<State>> chosen;
    for (const auto &name : full_names)
    {
      const auto field = std::find_if(table.begin(), table.end(), [&](const auto &known) { return known.full_name() == name; });
      AssertThrow(field != table.end(), dealii::ExcMessage("this method does not sample the field " + name));
      chosen.push_back(*field);
    }
    return chosen;
  }
} // namespace Stroma::Output
