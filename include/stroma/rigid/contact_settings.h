#pragma once

namespace Stroma
{
  class Parameters;
}

namespace Stroma::Rigid
{
  /// How well contact is solved for.
  struct ContactSettings
  {
    double penalty   = 100.; ///< over P-wave modulus over cell size
    double tolerance = 1e-6; ///< penetration over cell size

    /// Declares and reads the entries in the current section.
    void add(Parameters &p);
  };
} // namespace Stroma::Rigid
