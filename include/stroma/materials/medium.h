#pragma once

#include <limits>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Materials
{
  /// How the viscosity mu acts on a velocity field v with rate of deformation D.
  enum class ViscousOperator
  {
    central,   ///< 2 mu dev D + 5/3 mu tr D I: Appendix A of Heck 2017, and what central-force particles converge to
    morris,    ///< mu grad v (not symmetric): what the friction (6) of Heck 2017, after Morris, converges to
    deviatoric ///< 2 mu dev D
  };

  /// What a material is besides its constitutive law.
  struct Medium
  {
    double          density   = std::numeric_limits<double>::quiet_NaN(); ///< undeformed [kg/m^3], NaN: not given
    double          viscosity = 0.;                                       ///< mu [Pa s]
    ViscousOperator viscous_operator = ViscousOperator::central;
    bool            is_fluid         = false;
    double          bulk_modulus     = std::numeric_limits<double>::infinity(); ///< of a fluid [Pa]

    bool
    is_viscous() const
    {
      return viscosity > 0.;
    }

    /// Declares and reads the entries of the current section (after the law). Throws UserError.
    void add(Parameters &p);
  };
} // namespace Stroma::Materials
