#pragma once

namespace Stroma::Rigid
{
  /// What resists the motion of a rigid body besides the material, spread evenly over its shape.
  struct Resistance
  {
    double density          = 0.; ///< [kg/m^3], 0: not given
    double mass             = 0.; ///< m [kg]; 0: not given
    double drag             = 0.; ///< c of the force -c v [N s/m]
    double largest_approach = 0.; ///< way in a step of what touches nothing [m]; 0: not given
  };
} // namespace Stroma::Rigid
