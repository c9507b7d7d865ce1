#include <stroma/base/mixed_bits.h>
#include <stroma/processes/ornstein_uhlenbeck.h>

#include <cmath>

namespace Stroma::Processes
{
  namespace
  {
    constexpr unsigned int n_levels = 20;
    constexpr double       pi       = 3.14159265358979323846;

    /// In (0, 1].
    double
    uniform(const std::uint64_t bits)
    {
      return ((bits >> 11) + 1) * 0x1p-53;
    }
  } // namespace

  OrnsteinUhlenbeck::OrnsteinUhlenbeck(const double rate, const double diffusion, const std::uint64_t seed,
                                       const unsigned int component)
    : rate(rate)
    , diffusion(diffusion)
    , key(mixed_bits(mixed_bits(seed) + component))
    , distance(rate > 1. ? 1. / rate : 1.)
    , knots(1, 0.)
  {}

  /// Box and Muller's.
  double
  OrnsteinUhlenbeck::normal(const unsigned int level, const std::uint64_t place) const
  {
    const auto bits = mixed_bits(mixed_bits(key + level) + place);
    return std::sqrt(-2. * std::log(uniform(bits))) * std::cos(2. * pi * uniform(mixed_bits(bits)));
  }

  /// Of two values that are 2 @p h apart.
  double
  OrnsteinUhlenbeck::middle(const double left, const double right, const double h, const double number) const
  {
    const double kh       = rate * h;
    const double variance = diffusion * (kh > 0. ? std::tanh(kh) / rate : h);
    return (left + right) / (2. * std::cosh(kh)) + std::sqrt(variance) * number;
  }

  double
  OrnsteinUhlenbeck::at(const double t) const
  {
    const auto   knot     = static_cast<std::uint64_t>(t / distance);
    const double decay    = std::exp(-rate * distance);
    const double variance = rate > 0. ? diffusion / rate * (1. - decay * decay) : 2. * diffusion * distance;
    while (knots.size() < knot + 2)
      knots.push_back(decay * knots.back() + std::sqrt(variance) * normal(0, knots.size()));

    double        left = knots[knot], right = knots[knot + 1];
    double        part  = t / distance - double(knot); // of the way from left to right
    double        h     = .5 * distance;
    std::uint64_t place = knot;
    for (unsigned int level = 1; level <= n_levels; ++level, h *= .5)
      {
        const double       value    = middle(left, right, h, normal(level, place));
        const unsigned int is_right = part >= .5 ? 1 : 0;
        (is_right ? left : right)   = value;
        part                        = 2. * part - is_right;
        place                       = 2 * place + is_right;
      }
    return left + part * (right - left);
  }
} // namespace Stroma::Processes
