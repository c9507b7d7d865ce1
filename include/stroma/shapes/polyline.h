#pragma once

#include <deal.II/base/point.h>

#include <string>
#include <vector>

namespace Stroma::Shapes
{
  /**
   * Reads the text of a closed polyline: a line for each place, 'x y' or 'x, y', the last one the first again; empty lines and what
   * follows a # say nothing.
   * @return the corners in order, the first one once
   * Throws UserError, without the file's name, for what is none.
   */
  std::vector<dealii::Point<2>> read_polyline(const std::string &text);
} // namespace Stroma::Shapes
