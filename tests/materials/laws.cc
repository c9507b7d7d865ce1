// Closed forms of the laws against automatic differentiation of their energies, and analytic solutions.

#include "automatic_derivatives.h"
#include "points.h"

#include <stroma/materials/linear_elastic.h>
#include <stroma/materials/neo_hookean.h>

#include <gtest/gtest.h>

using namespace Points;
using Stroma::Materials::LinearElastic;
using Stroma::Materials::NeoHookean;

namespace
{
  template <typename Case>
  struct ElasticLaw : testing::Test
  {
    const typename Case::Law    law{collagen};
    const typename Case::Energy energy{collagen.mu, collagen.kappa};
  };

  using Cases =
    testing::Types<AutomaticDerivatives::LawAndEnergy<NeoHookean, AutomaticDerivatives::NeoHookeanEnergy>,
                   AutomaticDerivatives::LawAndEnergy<LinearElastic, AutomaticDerivatives::LinearElasticEnergy>>;
  TYPED_TEST_SUITE(ElasticLaw, Cases);

  SymmetricTensor<4, 3>
  rotate(const SymmetricTensor<4, 3> &C, const Tensor<2, 3> &Q)
  {
    SymmetricTensor<4, 3> rotated;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = i; j < 3; ++j)
        for (unsigned int k = 0; k < 3; ++k)
          for (unsigned int l = k; l < 3; ++l)
            for (unsigned int m = 0; m < 81; ++m)
              rotated[i][j][k][l] += Q[i][m / 27] * Q[j][m / 9 % 3] * Q[k][m / 3 % 3] * Q[l][m % 3] *
                                     C[m / 27][m / 9 % 3][m / 3 % 3][m % 3];
    return rotated;
  }
} // namespace

TYPED_TEST(ElasticLaw, StressAndTangentAreDerivativesOfTheEnergy)
{
  const auto F        = random(200, .4);
  const auto response = respond(this->law, F);
  ASSERT_EQ(response.status, StepStatus::ok);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const auto exact = differentiate(this->energy, F[p]);
      const auto tau   = kirchhoff_stress(exact, F[p]);
      const auto Jc    = spatial_tangent(exact, F[p]);
      EXPECT_NEAR(response.psi[p], exact.W, 1e-12 * (exact.W + collagen.mu));
      EXPECT_LT((Tensor<2, 3>(response.tau[p]) - tau).norm(), 1e-12 * tau.norm());
      EXPECT_LT((Tensor<4, 3>(response.Jc[p]) - Jc).norm(), 1e-12 * Jc.norm());
      EXPECT_EQ(response.F33[p], F[p][2][2]);
    }
}

TYPED_TEST(ElasticLaw, TangentHasMajorSymmetry)
{
  const auto response = respond(this->law, random(20, .4));
  for (const auto &Jc : response.Jc)
    for (unsigned int m = 0; m < 6; ++m)
      for (unsigned int n = 0; n < 6; ++n)
        EXPECT_EQ(Jc.access_raw_entry(6 * m + n), Jc.access_raw_entry(6 * n + m));
}

TYPED_TEST(ElasticLaw, IsObjectiveAndIsotropic)
{
  const auto                F = random(20, .4);
  const auto                Q = rotation();
  std::vector<Tensor<2, 3>> QF, FQ;
  for (const auto &F_p : F)
    {
      QF.push_back(Q * F_p);
      FQ.push_back(F_p * Q);
    }
  const auto response = respond(this->law, F), rotated = respond(this->law, QF), turned = respond(this->law, FQ);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const Tensor<2, 3> tau = Q * Tensor<2, 3>(response.tau[p]) * transpose(Q);
      EXPECT_LT((Tensor<2, 3>(rotated.tau[p]) - tau).norm(), 1e-12 * tau.norm());
      EXPECT_LT((rotated.Jc[p] - rotate(response.Jc[p], Q)).norm(), 1e-12 * response.Jc[p].norm());
      EXPECT_LT((turned.tau[p] - response.tau[p]).norm(), 1e-12 * tau.norm());
      EXPECT_LT((turned.Jc[p] - response.Jc[p]).norm(), 1e-12 * response.Jc[p].norm());
      EXPECT_NEAR(rotated.psi[p], response.psi[p], 1e-12 * collagen.mu);
    }
}

TYPED_TEST(ElasticLaw, RotationWithoutStrainGivesNoStressAndHookesTangent)
{
  const auto response = respond(this->law, {rotation()});
  EXPECT_LT(response.tau[0].norm(), 1e-12 * collagen.mu);
  EXPECT_NEAR(response.psi[0], 0., 1e-12 * collagen.mu);
  const auto Hooke = collagen.kappa *
                       outer_product(dealii::unit_symmetric_tensor<3>(), dealii::unit_symmetric_tensor<3>()) +
                     2. * collagen.mu * dealii::deviator_tensor<3>();
  EXPECT_LT((response.Jc[0] - Hooke).norm(), 1e-12 * Hooke.norm());
  EXPECT_NEAR(this->law.p_wave_modulus(), Hooke[0][0][0][0], 1e-12 * collagen.mu);
}

TYPED_TEST(ElasticLaw, StressIsHookesForSmallStrain)
{
  const double size     = 1e-6;
  const auto   F        = random(10, size);
  const auto   response = respond(this->law, F);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const auto strain = symmetrize(F[p]) - dealii::unit_symmetric_tensor<3>();
      const auto stress = collagen.lambda() * trace(strain) * dealii::unit_symmetric_tensor<3>() +
                          2. * collagen.mu * strain;
      EXPECT_LT((response.tau[p] - stress).norm(), 100. * size * size * collagen.kappa);
      EXPECT_GT(stress.norm(), .1 * size * collagen.mu);
    }
}

TYPED_TEST(ElasticLaw, ReportsInvertedAndNotFinitePoints)
{
  const auto         good = diagonal(1.1, .9, 1.);
  const double       inf  = std::numeric_limits<double>::infinity();
  const Tensor<2, 3> zero;
  EXPECT_EQ(respond(this->law, {good, diagonal(1., -.1, 1.)}).status, StepStatus::inverted_point);
  EXPECT_EQ(respond(this->law, {zero, good}).status, StepStatus::inverted_point);
  EXPECT_EQ(respond(this->law, {good, diagonal(not_a_number, 1., 1.)}).status, StepStatus::not_finite);
  EXPECT_EQ(respond(this->law, {diagonal(inf, 1., 1.), good}).status, StepStatus::not_finite);
  EXPECT_EQ(respond(this->law, {diagonal(1e200, 1., 1e-200)}).status, StepStatus::not_finite);
  EXPECT_EQ(respond(this->law, {good, diagonal(1., -.1, 1.), diagonal(not_a_number, 1., 1.)}).status,
            StepStatus::not_finite);
  EXPECT_EQ(respond(this->law, {}).status, StepStatus::ok);
}

TYPED_TEST(ElasticLaw, LeavesOutWhatIsNotWanted)
{
  const auto                             F    = random(3, .2);
  const auto                             full = respond(this->law, F);
  std::vector<double>                    psi(3);
  std::vector<SymmetricTensor<2, 3>>     tau(3);
  Stroma::Materials::MaterialOutput      wanted;
  const Stroma::Materials::MaterialInput input{dealii::make_array_view(F), {}, 0.};
  EXPECT_EQ(this->law.evaluate(input, wanted), StepStatus::ok);
  wanted.psi = dealii::make_array_view(psi);
  EXPECT_EQ(this->law.evaluate(input, wanted), StepStatus::ok);
  wanted     = {};
  wanted.tau = dealii::make_array_view(tau);
  EXPECT_EQ(this->law.evaluate(input, wanted), StepStatus::ok);
  EXPECT_EQ(psi, full.psi);
  EXPECT_EQ(tau, full.tau);
}

TEST(NeoHookean, StretchWithFreeSideGivesTheKnownForce)
{
  // Guilkey et al. 2006: collagen 537.6 um wide, 1 um thick, stretched by 10 % with F_zz = 1 and free sides.
  const double     stretch = 1.1;
  const NeoHookean law(collagen);
  double           narrow = .8, wide = 1.;
  for (unsigned int i = 0; i < 60; ++i)
    {
      const double side                                                               = .5 * (narrow + wide);
      (respond(law, {diagonal(side, stretch, 1.)}).tau[0][0][0] < 0. ? narrow : wide) = side;
    }
  const auto tau = respond(law, {diagonal(wide, stretch, 1.)}).tau[0];
  EXPECT_NEAR(tau[0][0], 0., 1e-10);
  EXPECT_NEAR(537.6e-6 * 1e-6 * tau[1][1] / stretch, 69.420e-9, .0005e-9);
}

TEST(NeoHookean, PressureIsKappaLnJ)
{
  const auto tau = respond(NeoHookean(collagen), {diagonal(1.2, 1.2, 1.2)}).tau[0];
  EXPECT_NEAR(tau[0][0], 1041.6 * 3. * std::log(1.2), 1e-11);
  EXPECT_NEAR(tau[1][1], tau[0][0], 1e-11);
  EXPECT_NEAR(tau[0][1], 0., 1e-11);
}

TEST(LinearElastic, UniaxialStrain)
{
  const LinearElastic law(collagen);
  for (const double F : {.8, 1.3})
    {
      const auto   response = respond(law, {diagonal(1., F, 1.)});
      const double E = .5 * (F * F - 1.), M = 1041.6 + 4. / 3. * 520.8;
      EXPECT_NEAR(response.tau[0][1][1], F * F * M * E, 1e-10);
      EXPECT_NEAR(response.tau[0][0][0], (1041.6 - 2. / 3. * 520.8) * E, 1e-10);
      EXPECT_NEAR(response.psi[0], .5 * M * E * E, 1e-10);
      EXPECT_NEAR(response.Jc[0][1][1][1][1], M * std::pow(F, 4), 1e-10);
    }
}

TEST(Laws, HaveNames)
{
  EXPECT_EQ(NeoHookean(collagen).name(), "neo-Hookean");
  EXPECT_EQ(LinearElastic(collagen).name(), "linear elastic");
}
