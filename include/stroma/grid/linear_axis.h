#pragma once

#include <utility>
#include <vector>

namespace Stroma
{
  /// Linear functions along an axis, of the nodes at a cell's ends.
  struct LinearAxis
  {
    static constexpr unsigned int n            = 2;    ///< nodes of a cell
    static constexpr bool         interpolates = true; ///< a node's place has its value

    /// Place of node @p i of the lattice, in cells.
    static double
    place(const unsigned int i, unsigned int /*n_cells*/)
    {
      return i;
    }

    /// How far from the place of node @p i a field is sampled for its coefficient [cells], and the weights.
    static std::vector<std::pair<double, double>>
    samples(unsigned int /*i*/, unsigned int /*n_cells*/)
    {
      return {{0., 1.}};
    }

    /// Values, and slopes over the unit cell, at @p xi of a cell; whether it is the first or the last of the axis.
    static void
    evaluate(const double xi, bool /*is_first*/, bool /*is_last*/, double (&value)[n], double (&slope)[n])
    {
      value[0] = 1. - xi;
      value[1] = xi;
      slope[0] = -1.;
      slope[1] = 1.;
    }
  };
} // namespace Stroma
