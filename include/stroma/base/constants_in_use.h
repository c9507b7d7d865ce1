#pragma once

#include <stroma/base/parameter_file.h>

#include <string>
#include <vector>

namespace Stroma
{
  /// Whether the value of an entry, which is not the constant itself, holds the name of a constant as a word.
  bool mentions(const ParameterFile::Entry &entry, const std::string &constant);

  /**
   * Constants may have any name, so that a misspelt one would be one more, and change nothing. Throws UserError for the first
   * of @p assignments ("Section/name=value", already in @p file) that gives a constant which no entry of the file mentions.
   */
  void require_use(const ParameterFile &file, const std::vector<std::string> &assignments);
} // namespace Stroma
