#pragma once

#include "../base/keep_largest.h"
#include "fixture.h"

#include <gtest/gtest.h>

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
          keep_largest(errors.worst, std::abs(K.el(i, j) + (plus(i) - minus(i)) / (2 * step)));
          keep_largest(errors.scale, std::abs(K.el(i, j)));
          keep_largest(errors.skew, std::abs(K.el(i, j) - K.el(j, i)));
        }
    }
  return errors;
}

/// Expects the tangent at @p u to be that of the forces, to the accuracy of differences, and symmetric.
template <int dim>
void
expect_tangent_of_forces(SystemFixture<dim> &s, const Stroma::Vector &u)
{
  Stroma::Vector r = u;
  Stroma::Matrix K;
  ASSERT_EQ(s.system->residual(r, u), Stroma::StepStatus::ok);
  ASSERT_EQ(s.system->tangent(K, r, u), Stroma::StepStatus::ok);
  const auto [worst, skew, scale] = tangent_errors(*s.system, K, u);
  EXPECT_LT(worst / scale, 2e-8);
  EXPECT_LT(skew / scale, 1e-13);
}
