#include <fstream>
#include <sstream>

#include "shape_file.h"

namespace Stroma::Shapes
{
  std::string
  bytes_of(const std::string &path)
  {
    std::ifstream     file(path, std::ios::binary);
    std::stringstream text;
    if (!(file && text << file.rdbuf()))
      throw UserError("it cannot be read, or is empty");
    return text.str();
  }

  void
  add_length_unit(Parameters &p, double &unit)
  {
    p.add_choice<double>("Length unit", unit, "unit of the coordinates in the file, which does not say",
                         {{"m", 1.}, {"mm", 1e-3}, {"um", 1e-6}, {"nm", 1e-9}});
  }
} // namespace Stroma::Shapes
