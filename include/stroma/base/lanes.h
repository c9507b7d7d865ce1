#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace Stroma
{
  /// @p n numbers side by side, one a node, with arithmetic entry by entry; in vector registers where n fits them.
  template <unsigned int n>
  struct LanesOf
  {
    struct type
    {
      double value[n];

      double &
      operator[](const unsigned int a)
      {
        return value[a];
      }
      double
      operator[](const unsigned int a) const
      {
        return value[a];
      }
      type &
      operator+=(const type &other)
      {
        for (unsigned int a = 0; a < n; ++a)
          value[a] += other.value[a];
        return *this;
      }
      type &
      operator/=(const double divisor)
      {
        for (double &v : value)
          v /= divisor;
        return *this;
      }
      friend type
      operator*(type left, const type &right)
      {
        for (unsigned int a = 0; a < n; ++a)
          left.value[a] *= right.value[a];
        return left;
      }
      friend type
      operator*(const double factor, type lanes)
      {
        for (double &v : lanes.value)
          v *= factor;
        return lanes;
      }
    };
  };
  template <>
  struct LanesOf<4>
  {
    typedef double type __attribute__((vector_size(32)));
  };
  template <>
  struct LanesOf<8>
  {
    typedef double type __attribute__((vector_size(64)));
  };
  template <unsigned int n>
  using Lanes = typename LanesOf<n>::type;

  /// Sum of the entries, always by halves.
  template <unsigned int n, unsigned int begin = 0, unsigned int size = n>
  inline double
  sum(const Lanes<n> &lanes)
  {
    if constexpr (size == 1)
      return lanes[begin];
    else
      return sum<n, begin, size / 2>(lanes) + sum<n, begin + size / 2, size - size / 2>(lanes);
  }

  /// The largest component at any node.
  template <unsigned int n, std::size_t dim>
  inline double
  largest(const std::array<Lanes<n>, dim> &u)
  {
    double result = 0;
    for (const auto &lanes : u)
      for (unsigned int a = 0; a < n; ++a)
        result = std::max(result, std::abs(lanes[a]));
    return result;
  }
} // namespace Stroma
