#include "exponential_law.h"

#include <algorithm>
#include <cmath>

namespace Stroma::Processes
{
  ExponentialLaw::ExponentialLaw(Parameters &p)
  {
    p.add("Rate", rate, "of degradation at the surface, 1/tau_degr", "1/s", Range::non_negative());
    p.add("Decay length", decay, "over which the rate falls to 1/e; Heck et al. have a quarter of the radius", "m",
          Range::positive());
  }

  double
  ExponentialLaw::after(const double f, const double d, const double dt) const
  {
    return std::max(0., f - dt * rate * std::exp(-std::max(d, 0.) / decay));
  }
} // namespace Stroma::Processes
