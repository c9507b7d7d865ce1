// The fluid's pressure and its tangent.

#include "automatic_derivatives.h"
#include "points.h"

#include <stroma/materials/fluid.h>

#include <gtest/gtest.h>

using namespace Points;
using Stroma::Materials::Fluid;

namespace
{
  /// K/2 (ln J)^2.
  struct FluidEnergy
  {
    double K;

    template <typename Number>
    Number
    operator()(const AutomaticDerivatives::Matrix<Number> &F) const
    {
      using std::log;
      const Number ln_J = log(AutomaticDerivatives::determinant(F));
      return .5 * K * ln_J * ln_J;
    }
  };
} // namespace

TEST(Fluid, StressAndTangentAreDerivativesOfTheEnergy)
{
  const double K        = 7.;
  const auto   F        = random(50, .4);
  const auto   response = respond(Fluid(K), F);
  ASSERT_EQ(response.status, StepStatus::ok);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const auto exact = AutomaticDerivatives::differentiate(FluidEnergy{K}, F[p]);
      const auto Jc    = AutomaticDerivatives::spatial_tangent(exact, F[p]);
      EXPECT_NEAR(response.psi[p], exact.W, 1e-12 * K);
      EXPECT_LT((Tensor<2, 3>(response.tau[p]) - AutomaticDerivatives::kirchhoff_stress(exact, F[p])).norm(),
                1e-12 * K);
      EXPECT_LT((Tensor<4, 3>(response.Jc[p]) - Jc).norm(), 1e-12 * K);
      EXPECT_EQ(response.F33[p], F[p][2][2]);
    }
}

TEST(Fluid, FeelsVolumeAlone)
{
  const auto tau = respond(Fluid(7.), {diagonal(2., .5, 1.), diagonal(1.2, 1., 1.)}).tau;
  EXPECT_LT(tau[0].norm(), 1e-14);
  EXPECT_NEAR(tau[1][2][2], 7. * std::log(1.2), 1e-14);
  EXPECT_EQ(Fluid(7.).p_wave_modulus(), 7.);
}

TEST(Fluid, ReportsInvertedAndNotFinitePoints)
{
  const auto good = diagonal(1.1, .9, 1.);
  EXPECT_EQ(respond(Fluid(1.), {good, diagonal(1., -.1, 1.)}).status, StepStatus::inverted_point);
  EXPECT_EQ(respond(Fluid(1.), {good, diagonal(not_a_number, 1., 1.)}).status, StepStatus::not_finite);
  EXPECT_EQ(respond(Fluid(1.), {diagonal(1., -.1, 1.), diagonal(not_a_number, 1., 1.)}).status, StepStatus::not_finite);
}
