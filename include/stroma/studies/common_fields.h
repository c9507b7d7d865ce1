#pragma once

#include <stroma/studies/compare.h>

namespace Stroma::Studies
{
  /// Times at which both sources have values and that @p options ask for. Throws UserError if there are none.
  std::vector<double> common_times(const FieldSource &a, const FieldSource &b, const CompareOptions &options);

  /// Fields to compare, gradients not among them: those that @p options name, or all that both sources have. Throws UserError
  /// if one of them lacks a field, or there are none.
  std::vector<std::string> common_fields(FieldSource &a, FieldSource &b, const CompareOptions &options);

  /// The same, and behind them the gradients that both sources have of them, for H1 semi norms.
  std::vector<std::string> with_gradients(const std::vector<std::string> &fields, FieldSource &a, FieldSource &b);

  /// The field that is the gradient of field @p name, for its H1 semi norm, or "".
  std::string gradient_of(const std::string &name);
} // namespace Stroma::Studies
