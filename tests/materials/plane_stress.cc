// Plane stress: tau_33 = 0, energy's derivatives with F33 eliminated, analytic solutions.

#include "automatic_derivatives.h"
#include "points.h"

#include <stroma/materials/linear_elastic.h>
#include <stroma/materials/neo_hookean.h>
#include <stroma/materials/plane_stress.h>

#include <gtest/gtest.h>

using namespace Points;
using Stroma::Materials::LinearElastic;
using Stroma::Materials::NeoHookean;
using Stroma::Materials::PlaneStress;

namespace
{
  template <typename Case>
  struct PlaneStressOf : testing::Test
  {
    const PlaneStress           law{std::make_unique<typename Case::Law>(collagen)};
    const typename Case::Energy energy{collagen.mu, collagen.kappa};
  };

  using Cases =
    testing::Types<AutomaticDerivatives::LawAndEnergy<NeoHookean, AutomaticDerivatives::NeoHookeanEnergy>,
                   AutomaticDerivatives::LawAndEnergy<LinearElastic, AutomaticDerivatives::LinearElasticEnergy>>;
  TYPED_TEST_SUITE(PlaneStressOf, Cases);

  Tensor<2, 3>
  with_F33(Tensor<2, 3> F, const double F33)
  {
    F[2][2] = F33;
    return F;
  }

  bool
  any_is_normal(const unsigned int i, const unsigned int j, const unsigned int k = 0, const unsigned int l = 0)
  {
    return i == 2 || j == 2 || k == 2 || l == 2;
  }

  /// Second derivative of min over F33 of W (implicit function theorem): A_iJkL - A_iJ33 A_33kL / A_3333.
  AutomaticDerivatives::Derivatives
  eliminate_F33(AutomaticDerivatives::Derivatives d)
  {
    const auto A = d.A;
    for (unsigned int i = 0; i < 3; ++i)
      for (unsigned int j = 0; j < 3; ++j)
        for (unsigned int k = 0; k < 3; ++k)
          for (unsigned int l = 0; l < 3; ++l)
            d.A[i][j][k][l] -= A[i][j][2][2] * A[2][2][k][l] / A[2][2][2][2];
    return d;
  }
} // namespace

TYPED_TEST(PlaneStressOf, StressAndTangentAreDerivativesOfTheReducedEnergy)
{
  const auto F        = random_in_plane(100, .3);
  const auto response = respond(this->law, F);
  ASSERT_EQ(response.status, StepStatus::ok);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const auto F_3d  = with_F33(F[p], response.F33[p]);
      const auto exact = differentiate(this->energy, F_3d);
      EXPECT_LT(std::abs(exact.P[2][2]), 1e-12 * collagen.kappa);
      EXPECT_NEAR(response.psi[p], exact.W, 1e-12 * (exact.W + collagen.mu));
      const auto tau = kirchhoff_stress(exact, F_3d);
      const auto Jc  = spatial_tangent(eliminate_F33(exact), F_3d);
      EXPECT_LT((Tensor<2, 3>(response.tau[p]) - tau).norm(), 1e-12 * collagen.kappa);
      for (unsigned int m = 0; m < 81; ++m)
        {
          const unsigned int i = m / 27, j = m / 9 % 3, k = m / 3 % 3, l = m % 3;
          const double       expected = any_is_normal(i, j, k, l) ? 0. : Jc[i][j][k][l];
          EXPECT_NEAR(response.Jc[p][i][j][k][l], expected, 1e-11 * Jc.norm());
        }
    }
}

TYPED_TEST(PlaneStressOf, TangentIsTheDerivativeOfTheStress)
{
  // Central differences of P_iJ = tau_ij F^-T_jJ through the local Newton iteration.
  const double h = 1e-5;
  for (const auto &F : random_in_plane(10, .3))
    {
      const auto at = respond(this->law, {F});
      const auto P  = [&](const Tensor<2, 3> &G) {
        return Tensor<2, 3>(respond(this->law, {G}).tau[0]) * transpose(invert(G));
      };
      for (unsigned int k = 0; k < 2; ++k)
        for (unsigned int L = 0; L < 2; ++L)
          {
            Tensor<2, 3> forward = F, backward = F, A;
            forward[k][L] += h;
            backward[k][L] -= h;
            A = (P(forward) - P(backward)) / (2. * h);
            for (unsigned int i = 0; i < 2; ++i)
              for (unsigned int J = 0; J < 2; ++J)
                {
                  double             exact = 0.;
                  const Tensor<2, 3> F_inv = invert(F);
                  for (unsigned int j = 0; j < 2; ++j)
                    for (unsigned int l = 0; l < 2; ++l)
                      exact += (at.Jc[0][i][j][k][l] + (i == k ? at.tau[0][j][l] : 0.)) * F_inv[J][j] * F_inv[L][l];
                  EXPECT_NEAR(A[i][J], exact, 1e-7 * collagen.kappa);
                }
          }
    }
}

TYPED_TEST(PlaneStressOf, OutOfPlaneStressIsZero)
{
  for (const auto &tau : respond(this->law, random_in_plane(50, .3)).tau)
    for (unsigned int d = 0; d < 3; ++d)
      EXPECT_EQ(tau[d][2], 0.);
}

TYPED_TEST(PlaneStressOf, IgnoresTheThirdRowAndColumn)
{
  const auto F = random_in_plane(5, .3);
  auto       G = F;
  for (auto &G_p : G)
    G_p[0][2] = G_p[2][1] = G_p[2][2] = 7.;
  const auto a = respond(this->law, F), b = respond(this->law, G);
  EXPECT_EQ(a.tau, b.tau);
  EXPECT_EQ(a.F33, b.F33);
}

TYPED_TEST(PlaneStressOf, BlocksDoNotMatter)
{
  const auto F    = random_in_plane(75, .4);
  const auto many = respond(this->law, F);
  ASSERT_EQ(F.size(), 75u);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const auto one = respond(this->law, {F[p]});
      EXPECT_EQ(many.tau[p], one.tau[0]);
      EXPECT_EQ(many.Jc[p], one.Jc[0]);
      EXPECT_EQ(many.psi[p], one.psi[0]);
      EXPECT_EQ(many.F33[p], one.F33[0]);
    }
}

TYPED_TEST(PlaneStressOf, LeavesOutWhatIsNotWanted)
{
  const auto                             F    = random_in_plane(40, .2);
  const auto                             full = respond(this->law, F);
  std::vector<double>                    F33(40);
  std::vector<SymmetricTensor<2, 3>>     tau(40);
  std::vector<SymmetricTensor<4, 3>>     Jc(40);
  Stroma::Materials::MaterialOutput      wanted;
  const Stroma::Materials::MaterialInput input{dealii::make_array_view(F), {}, 0.};
  wanted.tau = dealii::make_array_view(tau);
  EXPECT_EQ(this->law.evaluate(input, wanted), StepStatus::ok);
  wanted     = {};
  wanted.F33 = dealii::make_array_view(F33);
  EXPECT_EQ(this->law.evaluate(input, wanted), StepStatus::ok);
  wanted    = {};
  wanted.Jc = dealii::make_array_view(Jc);
  EXPECT_EQ(this->law.evaluate(input, wanted), StepStatus::ok);
  EXPECT_EQ(tau, full.tau);
  EXPECT_EQ(F33, full.F33);
  EXPECT_EQ(Jc, full.Jc);
}

TYPED_TEST(PlaneStressOf, ReportsInvertedAndNotFinitePoints)
{
  const auto good = diagonal(1.1, .9, 1.);
  EXPECT_EQ(respond(this->law, {good, diagonal(1., -.1, 1.)}).status, StepStatus::inverted_point);
  EXPECT_EQ(respond(this->law, {good, diagonal(-.1, 1., -1.)}).status, StepStatus::inverted_point);
  EXPECT_EQ(respond(this->law, {diagonal(not_a_number, 1., 1.), good}).status, StepStatus::not_finite);
  EXPECT_EQ(respond(this->law, {good, diagonal(1., 1., not_a_number)}).status, StepStatus::ok);
}

TYPED_TEST(PlaneStressOf, ModulusIsThatOfWavesInThePlane)
{
  const double nu = 2. / 7., E = 2. * (1. + nu) * 520.8; // kappa = 2 mu
  EXPECT_NEAR(this->law.p_wave_modulus(), E / (1. - nu * nu), 1e-9);
}

TEST(PlaneStressOfNeoHookean, StretchWithFreeSideGivesTheKnownForce)
{
  // Guilkey et al. 2006: collagen 537.6 um wide, 1 um thick, stretched by 10 % with sigma_zz = 0 and free sides.
  const double      stretch = 1.1;
  const PlaneStress law(std::make_unique<NeoHookean>(collagen));
  double            narrow = .8, wide = 1.;
  for (unsigned int i = 0; i < 60; ++i)
    {
      const double side                                                               = .5 * (narrow + wide);
      (respond(law, {diagonal(side, stretch, 1.)}).tau[0][0][0] < 0. ? narrow : wide) = side;
    }
  const auto at = respond(law, {diagonal(wide, stretch, 1.)});
  EXPECT_NEAR(at.F33[0], wide, 1e-12); // both sides are free
  EXPECT_NEAR(537.6e-6 * 1e-6 * at.tau[0][1][1] / stretch, 64.719e-9, .0005e-9);
}

TEST(PlaneStressOfNeoHookean, FindsF33FarFromTheReference)
{
  // Stretches from .05 to 20 in both directions, up to kappa = 1e5 mu; tau_33 as the law itself gives it.
  for (const double ratio : {.1, 2., 1e3, 1e5})
    {
      const ElasticConstants    constants{1., ratio};
      const NeoHookean          law(constants);
      std::vector<Tensor<2, 3>> F;
      for (const double a : {.05, .3, 1., 4., 20.})
        for (const double b : {.05, .8, 1., 1.5, 20.})
          F.push_back(diagonal(a, b, 1.));
      const auto response = respond(PlaneStress(std::make_unique<NeoHookean>(constants)), F);
      ASSERT_EQ(response.status, StepStatus::ok) << ratio;
      for (unsigned int p = 0; p < F.size(); ++p)
        {
          const auto solid = respond(law, {with_F33(F[p], response.F33[p])});
          EXPECT_NEAR(solid.tau[0][2][2], 0., 1e-12 * solid.Jc[0].norm()) << F[p];
        }
    }
}

TEST(PlaneStressOfLinearElastic, F33IsKnown)
{
  const PlaneStress law(std::make_unique<LinearElastic>(collagen));
  const double      lambda = collagen.lambda(), M = collagen.p_wave_modulus();
  const auto        F        = random_in_plane(50, .3);
  const auto        response = respond(law, F);
  for (unsigned int p = 0; p < F.size(); ++p)
    {
      const double in_plane = .5 * (F[p].norm_square() - 3.); // E11 + E22
      EXPECT_NEAR(response.F33[p], std::sqrt(1. - 2. * lambda / M * in_plane), 1e-12);
    }
}

TEST(PlaneStressOfLinearElastic, DivergesWhereNoF33Exists)
{
  // E33 = -.4 (E11 + E22) must be above -1/2.
  const PlaneStress law(std::make_unique<LinearElastic>(collagen));
  EXPECT_EQ(respond(law, {diagonal(1.49, 1.49, 1.)}).status, StepStatus::ok);
  EXPECT_EQ(respond(law, {diagonal(1.51, 1.51, 1.)}).status, StepStatus::diverged);
  EXPECT_EQ(respond(law, {diagonal(2.2, 2.2, 1.)}).status, StepStatus::diverged);
}
