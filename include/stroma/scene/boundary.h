#pragma once

#include <stroma/base/expression.h>
#include <stroma/rigid/rotation.h>
#include <stroma/scene/region.h>

namespace Stroma
{
  /// Prescribed displacement (of a solid) or velocity (of a fluid) of a side, of a set of material or of a rigid body;
  /// some components may be free. A rigid body may turn besides, about its pivot.
  template <int dim>
  struct Support
  {
    std::string          name;
    std::string          where; ///< place in the file
    Region<dim>          region;
    SpaceTimeVector<dim> displacement;           ///< [m] since the start; not given where the velocity is
    SpaceTimeVector<dim> velocity;               ///< [m/s], given only by 'Type = velocity'
    bool                 holds_rotation = false; ///< of a rigid body: whether it says how it turns

    SpaceTimeVector<dim, Rigid::n_rotations<dim>> rotation;         ///< of a rigid body [rad] since the start
    SpaceTimeVector<dim, Rigid::n_rotations<dim>> angular_velocity; ///< [rad/s], given only by 'Type = velocity'

    bool
    holds(const unsigned int component) const
    {
      return velocity.given() ? !velocity.is_free(component) : !displacement.is_free(component);
    }

    void add(Parameters &p, const SceneNames &names);

  private:
    void add_motion(Parameters &p, bool of_velocity);
    void add_rotation(Parameters &p, bool of_velocity);
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

    SpaceTimeVector<dim, Rigid::n_rotations<dim>> torque; ///< [N m], on a rigid body

    void add(Parameters &p, const SceneNames &names);

  private:
    void check(const Parameters &p) const;
  };
} // namespace Stroma
