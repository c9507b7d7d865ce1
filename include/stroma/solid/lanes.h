#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace Stroma::Solid
{
  /// One number a node of a linear cell, side by side in vector registers: 4 in 2D, 8 in 3D, in deal.II's vertex order.
  template <int dim>
  struct LanesOf;
  template <>
  struct LanesOf<2>
  {
    typedef double type __attribute__((vector_size(32)));
  };
  template <>
  struct LanesOf<3>
  {
    typedef double type __attribute__((vector_size(64)));
  };
  template <int dim>
  using Lanes = typename LanesOf<dim>::type;

  template <int dim>
  inline double
  sum(const Lanes<dim> &lanes)
  {
    if constexpr (dim == 2)
      return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    else
      return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
  }

  /// The largest component at any node.
  template <int dim>
  inline double
  largest(const std::array<Lanes<dim>, dim> &u)
  {
    double result = 0;
    for (const auto &lanes : u)
      for (unsigned int a = 0; a < (1u << dim); ++a)
        result = std::max(result, std::abs(lanes[a]));
    return result;
  }
} // namespace Stroma::Solid
