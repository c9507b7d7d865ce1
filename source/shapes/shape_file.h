#pragma once

#include <stroma/base/parameters.h>

#include <string>

namespace Stroma::Shapes
{
  /// All of a file. Throws UserError, without its name, if there is nothing.
  std::string bytes_of(const std::string &path);

  /// Declares and reads 'Length unit' of a file of coordinates. @param unit [m]
  void add_length_unit(Parameters &p, double &unit);
} // namespace Stroma::Shapes
