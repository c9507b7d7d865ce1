#pragma once

#include <limits>

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Materials
{
  /// The two constants of isotropic elasticity at the reference state.
  struct ElasticConstants
  {
    double mu    = std::numeric_limits<double>::quiet_NaN(); ///< shear modulus [Pa]
    double kappa = std::numeric_limits<double>::quiet_NaN(); ///< bulk modulus [Pa]

    /// First Lame constant [Pa].
    double
    lambda() const
    {
      return kappa - 2. / 3. * mu;
    }

    /// Modulus of longitudinal waves, kappa + 4/3 mu [Pa].
    double
    p_wave_modulus() const
    {
      return kappa + 4. / 3. * mu;
    }

    /**
     * Reads the constants from the current section, which must give exactly two of `Young's modulus`,
     * `Poisson's ratio`, `Shear modulus` and `Bulk modulus`. Throws UserError if it gives another number of them, or
     * a pair for which mu or kappa would not be positive. In Parameters::Mode::document all four are declared and the
     * constants stay NaN unless two are given.
     */
    void add(Parameters &p);
  };
} // namespace Stroma::Materials
