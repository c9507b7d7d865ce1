#pragma once

#include "fixture.h"

#include <algorithm>
#include <cmath>

/// What differs between a tangent and central differences of the residual, and between it and its transpose.
struct TangentErrors
{
  double worst = 0., skew = 0.; ///< largest differences
  double scale = 0.;            ///< largest entry
};

/// Those of @p system at displacements @p u, but for the last @p n_left_out unknowns; @p K is the tangent there.
template <typename System>
TangentErrors
tangent_errors(System &system, const Stroma::Matrix &K, const Stroma::Vector &u, const unsigned int n_left_out = 0)
{
  const unsigned int n    = u.size() - n_left_out;
  constexpr double   step = 1e-6;
  TangentErrors      errors;
  Stroma::Vector     plus = u, minus = u;
  for (unsigned int j = 0; j < n; ++j)
    {
      Stroma::Vector shifted = u;
      shifted(j) += step;
      system.residual(plus, shifted);
      shifted(j) -= 2 * step;
      system.residual(minus, shifted);
      for (unsigned int i = 0; i < n; ++i)
        {
          errors.worst = std::max(errors.worst, std::abs(K.el(i, j) + (plus(i) - minus(i)) / (2 * step)));
          errors.scale = std::max(errors.scale, std::abs(K.el(i, j)));
          errors.skew  = std::max(errors.skew, std::abs(K.el(i, j) - K.el(j, i)));
        }
    }
  return errors;
}
