#pragma once

#include <cstdint>

namespace Stroma
{
  /// A hash of whole numbers whose bits all depend on all of @p z: finaliser of SplitMix64 (Steele, Lea, Flood 2014).
  inline std::uint64_t
  mixed_bits(std::uint64_t z)
  {
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
} // namespace Stroma
