#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace Stroma
{
  /**
   * Quadratic B-splines along an axis of n cells, with knots at the cells' ends: n + 2 functions, of which three live in a
   * cell; their gradients are continuous. The end knots are threefold (open knot vector, de Boor 1978), so that the
   * outermost functions alone are not zero at the ends of the axis, and nodes can be held there. The nodes' places are the
   * Greville abscissae, at which linear fields are reproduced. On the background grid: Steffen, Kirby & Berzins 2008.
   */
  struct QuadraticBSplineAxis
  {
    static constexpr unsigned int n            = 3;
    static constexpr bool         interpolates = false; ///< but at the ends

    static double
    place(const unsigned int i, const unsigned int n_cells)
    {
      return std::min(std::max(i - .5, 0.), double(n_cells));
    }

    /// Exact for quadratic fields (Lee, Lyche & Schumaker 2001).
    static std::vector<std::pair<double, double>>
    samples(const unsigned int i, const unsigned int n_cells)
    {
      if (i == 0 || i == n_cells + 1)
        return {{0., 1.}};
      return {{-.5, -.5}, {0., 2.}, {.5, -.5}};
    }

    static void
    evaluate(const double xi, const bool is_first, const bool is_last, double (&value)[n], double (&slope)[n])
    {
      const double below = is_first ? 1. : .5, above = is_last ? 1. : .5; // 1 / knot spans under the outer functions
      value[0] = below * (1. - xi) * (1. - xi);
      value[2] = above * xi * xi;
      value[1] = 1. - value[0] - value[2];
      slope[0] = -2. * below * (1. - xi);
      slope[2] = 2. * above * xi;
      slope[1] = -slope[0] - slope[2];
    }
  };
} // namespace Stroma
