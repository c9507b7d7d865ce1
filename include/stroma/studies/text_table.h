#pragma once

#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// Rows of cells; the first row is the header.
  using Rows = std::vector<std::vector<std::string>>;

  /// Columns aligned to the right, two spaces between them.
  std::string aligned(const Rows &rows);

  /// Comma-separated values; cells with a comma or a quote are quoted.
  std::string csv(const Rows &rows);

  /// "%.6g" and the like; "-" for what is not a number.
  std::string text_of(const char *format, double value);
} // namespace Stroma::Studies
