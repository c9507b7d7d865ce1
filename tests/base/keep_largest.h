#pragma once

#include <cmath>

/// Makes @p largest the larger of itself and @p x; no number as soon as one of them is none, which std::max() would leave out.
inline void
keep_largest(double &largest, const double x)
{
  if (!std::isnan(largest) && !(x <= largest))
    largest = x;
}
