#pragma once

namespace Stroma
{
  constexpr unsigned int
  power(const unsigned int base, const unsigned int exponent)
  {
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
  }
} // namespace Stroma
