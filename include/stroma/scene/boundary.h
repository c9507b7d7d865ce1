#pragma once

#include <stroma/base/expression.h>
#include <stroma/scene/region.h>

namespace Stroma
{
  /// Prescribed displacement (of a solid) or velocity (of a fluid) of a side, of a set of material or of a rigid body;
  /// some components may be free.
  template <int dim>
  struct Support
  {
    std::string          name;
    std::string          where; ///< place in the file
    Region<dim>          region;
    SpaceTimeVector<dim> displacement; ///< [m] since the start; not given where the velocity is
    SpaceTimeVector<dim> velocity;     ///< [m/s], given only by 'Type = velocity'

    bool
    holds(const unsigned int component) const
    {
      return velocity.given() ? !velocity.is_free(component) : !displacement.is_free(component);
    }

    void add(Parameters &p, const SceneNames &names);
  };

  /// A dead load, given by its density over the undeformed volume or area, or by its total.
  template <int dim>
  struct Load
  {
    std::string          name;
    std::string          where;
    Region<dim>          region;
    SpaceTimeVector<dim> density;  ///< [N/m^3]
    SpaceTimeVector<dim> traction; ///< [N/m^2], on parts of the boundary
    SpaceTimeVector<dim> total;    ///< [N]; spread over the region in proportion to volume or area, or on a rigid body

    void add(Parameters &p, const SceneNames &names);
  };
} // namespace Stroma
