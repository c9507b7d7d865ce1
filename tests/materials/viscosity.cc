// Viscous stress of spin, dilation and shear with the three operators.

#include "points.h"

#include <stroma/materials/viscosity.h>

#include <gtest/gtest.h>

using namespace Points;
using Stroma::Materials::Medium;
using Stroma::Materials::viscous_stress;
using Stroma::Materials::ViscousOperator;

namespace
{
  constexpr double mu = 3.;

  Medium
  medium(const ViscousOperator viscous_operator)
  {
    Medium medium;
    medium.viscosity        = mu;
    medium.viscous_operator = viscous_operator;
    return medium;
  }

  const Medium central = medium(ViscousOperator::central), morris = medium(ViscousOperator::morris),
               deviatoric = medium(ViscousOperator::deviatoric);
} // namespace

TEST(Viscosity, OnlyMorrisResistsSpin)
{
  const Tensor<2, 3> spin({{0., -2., 1.}, {2., 0., -.5}, {-1., .5, 0.}});
  EXPECT_EQ(viscous_stress(central, spin).norm(), 0.);
  EXPECT_EQ(viscous_stress(deviatoric, spin).norm(), 0.);
  EXPECT_EQ(viscous_stress(morris, spin), mu * spin);
}

TEST(Viscosity, OfDilation)
{
  const auto dilation = diagonal(1., 1., 1.); // tr D = 3
  EXPECT_LT((viscous_stress(central, dilation) - 5. * mu * dilation).norm(), 1e-14);
  EXPECT_LT(viscous_stress(deviatoric, dilation).norm(), 1e-14);
  EXPECT_EQ(viscous_stress(morris, dilation), mu * dilation);
}

TEST(Viscosity, OfSimpleShear)
{
  Tensor<2, 3> L;
  L[0][1] = 2.;
  EXPECT_EQ(viscous_stress(central, L), mu * (L + transpose(L)));
  EXPECT_EQ(viscous_stress(deviatoric, L), mu * (L + transpose(L)));
  EXPECT_EQ(viscous_stress(morris, L), mu * L); // of v_0 in direction 1: stress_01 alone
}

TEST(Viscosity, IsAppendixAOfHeck)
{
  for (const auto &L : random(10, .5))
    {
      const auto D = symmetrize(L);
      EXPECT_LT((viscous_stress(deviatoric, L) - 2. * mu * Tensor<2, 3>(deviator(D))).norm(), 1e-13);
      const auto bulk = 5. / 3. * mu * trace(D) * Tensor<2, 3>(dealii::unit_symmetric_tensor<3>()); // (39), (43)
      EXPECT_LT((viscous_stress(central, L) - 2. * mu * Tensor<2, 3>(deviator(D)) - bulk).norm(), 1e-13);
    }
}
