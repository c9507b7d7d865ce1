#pragma once

#include <stroma/processes/degradation_law.h>

namespace Stroma::Processes
{
  /// df/dt = -k exp(-d/l) until f = 0, (35) of Heck 2017.
  class ExponentialLaw : public DegradationLaw
  {
  public:
    explicit ExponentialLaw(Parameters &p);

    double after(double f, double d, double dt) const override;

  private:
    double rate  = std::numeric_limits<double>::quiet_NaN(); ///< k [1/s]
    double decay = std::numeric_limits<double>::quiet_NaN(); ///< l [m]
  };
} // namespace Stroma::Processes
