#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace Stroma::Image
{
  /// Random draws that are the same with every standard library, unlike those of std::*_distribution.
  class Random
  {
  public:
    explicit Random(const std::uint64_t seed)
      : engine(seed)
    {}

    /// Uniform in [0, 1).
    double
    uniform()
    {
      return (engine() >> 11) * 0x1p-53;
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
    double
    normal()
    {
      if (has_spare)
        {
          has_spare = false;
          return spare;
        }
      const double radius = std::sqrt(-2 * std::log(1 - uniform()));
      const double angle  = 2 * 3.14159265358979323846 * uniform();
      spare               = radius * std::sin(angle);
      has_spare           = true;
      return radius * std::cos(angle);
    }

  private:
    std::mt19937_64 engine;
    double          spare     = 0;
    bool            has_spare = false;
  };
} // namespace Stroma::Image
