#pragma once

#include <stroma/base/expression.h>
#include <stroma/scene/region.h>

namespace Stroma
{
  /// Prescribed displacement of a side or of a set of material; some components may be free.
  template <int dim>
  struct Support
  {
    std::string          name;
    std::string          where; ///< place in the file
    Region<dim>          region;
    SpaceTimeVector<dim> displacement; ///< [m] since the start

    void add(Parameters &p, const std::vector<std::string> &materials);
  };

  /// A dead load, given by its density over the reference volume or by its total.
  template <int dim>
  struct Load
  {
    std::string          name;
    std::string          where;
    Region<dim>          region;
    SpaceTimeVector<dim> density; ///< [N/m^3]
    SpaceTimeVector<dim> total;   ///< [N]; spread over the region in proportion to volume

    void add(Parameters &p, const std::vector<std::string> &materials);
  };
} // namespace Stroma
