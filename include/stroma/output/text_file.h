#pragma once

#include <string>

namespace Stroma::Output
{
  /// Replaces the file @p path by @p text in one go (temporary file, then rename): a reader or a crash never sees half
  /// of it. Local to the calling rank. Throws OutputError with the path and the system's reason.
  void write_atomically(const std::string &path, const std::string &text);

  /// A cell of a comma-separated table, in quotes where it needs them (RFC 4180).
  std::string csv_cell(std::string text);

  /// The shortest text that reads back as exactly this number; "nan", "inf" or "-inf" where it is not finite.
  std::string to_text(double number);
} // namespace Stroma::Output
