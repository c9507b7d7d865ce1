// The small-strain limit of the laws: Hooke's law of sym F - I, and its out-of-plane stretch in plane stress.

#include "points.h"

#include <stroma/materials/fluid.h>
#include <stroma/materials/linear_elastic.h>
#include <stroma/materials/neo_hookean.h>
#include <stroma/materials/plane_stress.h>

#include <gtest/gtest.h>

using namespace Points;
using Stroma::Materials::Fluid;
using Stroma::Materials::LinearElastic;
using Stroma::Materials::NeoHookean;
using Stroma::Materials::PlaneStress;

namespace
{
  SymmetricTensor<2, 3>
  hooke(const SymmetricTensor<2, 3> &eps)
  {
    return collagen.lambda() * trace(eps) * I + 2. * collagen.mu * eps;
  }

  template <typename Law>
  struct SmallStrainOf : testing::Test
  {
    const std::unique_ptr<Material> law = Law(collagen).small_strain();
  };

  using Laws = testing::Types<NeoHookean, LinearElastic>;
  TYPED_TEST_SUITE(SmallStrainOf, Laws);
} // namespace

TYPED_TEST(SmallStrainOf, IsHookesLawAtAnyStrain)
{
  const auto F        = random(50, .8);
  const auto response = respond(*this->law, F);
  ASSERT_EQ(response.status, StepStatus::ok);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const auto eps = symmetrize(F[p]) - I, sigma = hooke(eps);
      EXPECT_LT((response.tau[p] - sigma).norm(), 1e-12 * collagen.kappa);
      EXPECT_LT((response.Jc[p] * eps - sigma).norm(), 1e-12 * collagen.kappa);
      EXPECT_NEAR(response.psi[p], .5 * (eps * sigma), 1e-12 * collagen.kappa);
      EXPECT_EQ(response.F33[p], F[p][2][2]);
    }
}

TYPED_TEST(SmallStrainOf, KeepsNameModulusAndLimit)
{
  const TypeParam finite(collagen);
  EXPECT_EQ(this->law->name(), finite.name());
  EXPECT_EQ(this->law->p_wave_modulus(), finite.p_wave_modulus());
  const auto F = random(5, .5);
  EXPECT_EQ(respond(*this->law->small_strain(), F).tau, respond(*this->law, F).tau);
}

TYPED_TEST(SmallStrainOf, MindsNumbersThatAreNotFiniteAlone)
{
  const auto good = diagonal(1.1, .9, 1.);
  EXPECT_EQ(respond(*this->law, {good, diagonal(1., -.1, 1.)}).status, StepStatus::ok);
  EXPECT_EQ(respond(*this->law, {diagonal(not_a_number, 1., 1.), good}).status, StepStatus::not_finite);
  EXPECT_EQ(respond(*this->law, {good, diagonal(1e200, 1., 1.)}).status, StepStatus::not_finite);
}

TYPED_TEST(SmallStrainOf, PlaneStressIsHookesPlaneStress)
{
  // kappa = 2 mu: nu = 2/7.
  const double nu = 2. / 7., E = 2. * (1. + nu) * collagen.mu;
  const auto   law      = PlaneStress(std::make_unique<TypeParam>(collagen)).small_strain();
  const auto   F        = random_in_plane(50, .5);
  const auto   response = respond(*law, F);
  ASSERT_EQ(response.status, StepStatus::ok);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const auto eps = symmetrize(F[p]) - I;
      EXPECT_NEAR(response.tau[p][0][0], E / (1. - nu * nu) * (eps[0][0] + nu * eps[1][1]), 1e-12 * collagen.kappa);
      EXPECT_NEAR(response.tau[p][1][1], E / (1. - nu * nu) * (eps[1][1] + nu * eps[0][0]), 1e-12 * collagen.kappa);
      EXPECT_NEAR(response.tau[p][0][1], 2. * collagen.mu * eps[0][1], 1e-12 * collagen.kappa);
      EXPECT_EQ(response.tau[p][2][2], 0.);
      EXPECT_NEAR(response.F33[p], 1. - nu / (1. - nu) * (eps[0][0] + eps[1][1]), 1e-13);
    }
}

TYPED_TEST(SmallStrainOf, PlaneStressIsTheLimitOfTheLaws)
{
  const double      size = 1e-6;
  const PlaneStress finite(std::make_unique<TypeParam>(collagen));
  const auto        F = random_in_plane(10, size);
  const auto        a = respond(finite, F), b = respond(*finite.small_strain(), F);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      EXPECT_NEAR(a.F33[p], b.F33[p], 100. * size * size);
      EXPECT_LT((a.tau[p] - b.tau[p]).norm(), 100. * size * size * collagen.kappa);
      EXPECT_GT(std::abs(b.F33[p] - 1.), 1e-3 * size);
    }
}

TEST(SmallStrainOfFluid, IsAPressure)
{
  const auto law      = Fluid(3.).small_strain();
  const auto F        = random(5, .5);
  const auto response = respond(*law, F);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      EXPECT_LT((response.tau[p] - 3. * (trace(F[p]) - 3.) * I).norm(), 1e-13);
      EXPECT_EQ(response.F33[p], F[p][2][2]);
    }
}
