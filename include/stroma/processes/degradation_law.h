#pragma once

#include <stroma/base/parameters.h>

#include <memory>

namespace Stroma::Processes
{
  /// How fast matter is degraded at a place near a body. The factor f is 1 where it is intact, and 0 where it has become a fluid.
  class DegradationLaw
  {
  public:
    virtual ~DegradationLaw() = default;

    /// f after @p dt [s] at the distance @p d [m] from the body's surface: the exact solution of the law, in [0, f].
    virtual double after(double f, double d, double dt) const = 0;
  };

  /// Declares and reads the entry 'Law' and those of the law, in the current section. A new law is a file and a line there.
  std::shared_ptr<const DegradationLaw> degradation_law(Parameters &p);
} // namespace Stroma::Processes
