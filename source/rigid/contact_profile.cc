#include <stroma/rigid/contact_profile.h>

#include <algorithm>

namespace Stroma::Rigid
{
  double
  contact_half_width(std::vector<std::array<double, 2>> profile)
  {
    const std::size_t n = profile.size();
    if (n < 2)
      return 0.;
    std::sort(profile.begin(), profile.end());
    const auto edge = [](const std::array<double, 2> &inner, const std::array<double, 2> &outer) {
      const double fall   = inner[1] * inner[1] - outer[1] * outer[1];
      const double beyond = fall > 0. ? std::min(1., outer[1] * outer[1] / fall) : 1.;
      return outer[0] + beyond * (outer[0] - inner[0]);
    };
    return .5 * (edge(profile[n - 2], profile[n - 1]) - edge(profile[1], profile[0]));
  }
} // namespace Stroma::Rigid
