#pragma once

#include <stroma/base/parameter_file.h>

#include <string>
#include <vector>

namespace Stroma
{
  /// Whether the value of an entry, which is not the constant itself, holds the name of a constant as a word.
  bool mentions(const ParameterFile::Entry &entry, const std::string &constant);

  /**
   * @p file with @p assignments ("Section/name=value") set. Constants may have any name, so that a misspelt one would be one more,
   * and change nothing: throws UserError for the first that gives a constant which no entry mentions, and what
   * ParameterFile::set() throws.
   */
  ParameterFile with_assignments(ParameterFile file, const std::vector<std::string> &assignments);
} // namespace Stroma
