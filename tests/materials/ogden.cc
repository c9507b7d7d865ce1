// Ogden's law: its special case, its tangent against differences, and simple tension of an incompressible solid.

#include "points.h"

#include <stroma/materials/neo_hookean.h>
#include <stroma/materials/ogden.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Points;
  using Stroma::Materials::NeoHookean;
  using Stroma::Materials::Ogden;

  const Ogden rubber({{1.491, 1.3}, {.003, 5.}, {-.0237, -2.}}, 500.); // [MPa], Ogden 1972

  TEST(Ogden, OfOneTermWithExponentTwoIsNeoHookean)
  {
    const Ogden ogden({{collagen.mu, 2.}}, collagen.kappa);
    auto        F = random(100, .4);
    F.push_back(diagonal(1., 1., 1.));
    F.push_back(diagonal(1.3, 1.3, .7));
    const auto a = respond(ogden, F), b = respond(NeoHookean(collagen), F);
    for (unsigned int p = 0; p < F.size(); ++p)
      {
        EXPECT_NEAR(a.psi[p], b.psi[p], 1e-11 * collagen.kappa);
        EXPECT_LT((a.tau[p] - b.tau[p]).norm(), 1e-11 * collagen.kappa);
        EXPECT_LT((a.Jc[p] - b.Jc[p]).norm(), 1e-8 * b.Jc[p].norm());
      }
    EXPECT_NEAR(ogden.p_wave_modulus(), NeoHookean(collagen).p_wave_modulus(), 1e-9);
  }

  // dP_iJ/dF_kL F_jJ F_lL = Jc_ijkl + delta_ik tau_jl.
  TEST(Ogden, TangentEqualsDifferencesOfTheStress)
  {
    auto all = random(30, .3);
    all.push_back(diagonal(1.2, 1.2, .8)); // two equal stretches
    all.push_back(diagonal(1.1, 1.1, 1.1));
    const double step = 1e-6;
    for (const auto &F : all)
      {
        const auto   at    = respond(rubber, {F});
        const double scale = at.Jc[0].norm();
        for (unsigned int k = 0; k < 3; ++k)
          for (unsigned int l = 0; l < 3; ++l)
            {
              Tensor<2, 3> direction;
              direction[k][l] = 1.;
              const auto plus = F + step * direction * F, minus = F - step * direction * F;
              const auto P = [&](const Tensor<2, 3> &G) {
                return Tensor<2, 3>(respond(rubber, {G}).tau[0]) * transpose(invert(G));
              };
              const auto slope = (P(plus) - P(minus)) * transpose(F) / (2. * step);
              for (unsigned int i = 0; i < 3; ++i)
                for (unsigned int j = 0; j < 3; ++j)
                  EXPECT_NEAR(slope[i][j], at.Jc[0][i][j][k][l] + (i == k) * at.tau[0][j][l], 2e-7 * scale);
            }
      }
  }

  // Simple tension: with the sides free of stress, sigma_1 = sum_p mu_p (lambda^alpha_p - lambda^(-alpha_p/2)).
  TEST(Ogden, SimpleTensionIsTheFormulaOfAnIncompressibleSolid)
  {
    for (const double lambda : {.6, 1.5, 3., 5.})
      {
        const double side  = 1. / std::sqrt(lambda); // det F = 1; the pressure follows from the free sides
        const auto   at    = respond(rubber, {diagonal(lambda, side, side)});
        double       exact = 0;
        for (const auto &[mu, alpha] : {std::pair(1.491, 1.3), std::pair(.003, 5.), std::pair(-.0237, -2.)})
          exact += mu * (std::pow(lambda, alpha) - std::pow(lambda, -.5 * alpha));
        EXPECT_NEAR(at.tau[0][0][0] - at.tau[0][1][1], exact, 1e-12 * std::abs(exact));
      }
  }

  TEST(Ogden, RefusesPointsTurnedInsideOut)
  {
    EXPECT_EQ(respond(rubber, {diagonal(-1., 1., 1.)}).status, StepStatus::inverted_point);
    EXPECT_EQ(respond(rubber, {diagonal(not_a_number, 1., 1.)}).status, StepStatus::not_finite);
    Tensor<2, 3> sheared = diagonal(1e200, 1e-200, 1.); // det F = 1, b is not finite
    sheared[0][1]        = 1e200;
    EXPECT_EQ(respond(rubber, {sheared}).status, StepStatus::not_finite);
  }
} // namespace
