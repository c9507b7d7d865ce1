#pragma once

#include <stroma/image/phantom.h>
#include <stroma/image/random.h>

namespace Stroma::Image
{
  /**
   * Grow branching tubes until exactly round(vessel_fraction * number of voxels) voxels are vessel (255; else 0); the
   * last tube is cut there. Tubes are persistent random walks whose radius drifts slowly; at a branching the radii obey
   * Murray's law r^3 = r_1^3 + r_2^3 (Murray 1926); a tube ends where it leaves the box or runs into another one.
   */
  Volume<std::uint8_t> grow_tubes(const PhantomSettings &settings, Random &random);
} // namespace Stroma::Image
