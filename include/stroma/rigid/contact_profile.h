#pragma once

#include <array>
#include <vector>

namespace Stroma::Rigid
{
  /// Half width of a contact in the plane [m] from its @p profile: place along the surface [m] and pressure [Pa] of each of its
  /// points. Near the edges p^2 falls linearly (Hertz): the edge is where it would be 0, by the last two points.
  double contact_half_width(std::vector<std::array<double, 2>> profile);
} // namespace Stroma::Rigid
