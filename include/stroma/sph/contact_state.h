#pragma once

#include <cstdint>

namespace Stroma::Sph
{
  /// What a particle is in of each contact of the scene, as bits of one number.
  namespace ContactState
  {
    constexpr unsigned int max_contacts = 21;

    /// Has pairs with the body of contact @p c.
    constexpr std::uint64_t
    touches(const unsigned int c)
    {
      return std::uint64_t(1) << c;
    }
    /// Is a primary particle of it (criterion heck).
    constexpr std::uint64_t
    primary(const unsigned int c)
    {
      return std::uint64_t(1) << (max_contacts + c);
    }
    /// Slides along it against friction (Coulomb).
    constexpr std::uint64_t
    slides(const unsigned int c)
    {
      return std::uint64_t(1) << (2 * max_contacts + c);
    }
    constexpr std::uint64_t all = ~std::uint64_t(0); ///< of fixed particles
  }                                                  // namespace ContactState
} // namespace Stroma::Sph
