// A block of several materials gives what their laws give, one by one, and keeps their histories apart.

#include "points.h"

#include <stroma/materials/material_block.h>
#include <stroma/materials/neo_hookean.h>
#include <stroma/materials/plane_stress.h>
#include <stroma/materials/prony.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;
  using namespace Stroma::Materials;

  const ElasticConstants relaxed{2., 5.};
  const PronySeries      one{relaxed, {.5}, {.3}, {.2}}, two{relaxed, {.5, 2.}, {.3, .1}, {.2, .4}};

  struct ThreeLaws
  {
    std::vector<std::unique_ptr<Material>> owned;
    std::vector<unsigned int>              material;
    std::vector<dealii::Tensor<2, 3>>      F;

    ThreeLaws()
      : material({0, 0, 1, 2, 2, 2})
      , F(Points::random(6, .2))
    {
      owned.push_back(std::make_unique<Prony>(one));
      owned.push_back(std::make_unique<NeoHookean>(relaxed));
      owned.push_back(std::make_unique<Prony>(two));
    }

    MaterialBlock
    block() const
    {
      MaterialBlock result(pointers_to(owned));
      result.resize(F.size());
      result.runs = {{0, 0, 2}, {1, 2, 3}, {2, 3, 6}};
      std::copy(F.begin(), F.end(), result.F.begin());
      return result;
    }
  };

  TEST(MaterialBlock, GivesWhatTheLawsGiveOneByOne)
  {
    const ThreeLaws c;
    MaterialBlock   block = c.block();
    EXPECT_EQ(block.n_history(), 18u); // of the longest memory

    // Two steps of .3 s, each from what the last one stored.
    std::vector<double>              stored(c.F.size() * block.n_history(), 0.);
    std::vector<std::vector<double>> history;
    for (const unsigned int m : c.material)
      history.emplace_back(c.owned[m]->n_history(), 0.);
    for (unsigned int step = 0; step < 2; ++step)
      {
        block.dt = .3;
        block.gather_history([&](const unsigned int p) { return stored.data() + p * block.n_history(); });
        ASSERT_EQ(block.evaluate(energy | tangent | stretch | next_step), StepStatus::ok);
        block.store_history([&](const unsigned int p) { return stored.data() + p * block.n_history(); });
        for (unsigned int p = 0; p < c.F.size(); ++p)
          {
            dealii::SymmetricTensor<2, 3> tau;
            dealii::SymmetricTensor<4, 3> Jc;
            double                        psi;
            std::vector<double>           next(history[p].size());
            ASSERT_EQ(
              c.owned[c.material[p]]->evaluate({{&c.F[p], 1}, dealii::make_array_view(history[p]), .3},
                                               {{&tau, 1}, {&Jc, 1}, {&psi, 1}, {}, dealii::make_array_view(next)}),
              StepStatus::ok);
            EXPECT_EQ((block.tau[p] - tau).norm(), 0.);
            EXPECT_EQ((block.Jc[p] - Jc).norm(), 0.);
            EXPECT_EQ(block.psi[p], psi);
            EXPECT_EQ(block.F33[p], c.F[p][2][2]);
            for (unsigned int i = 0; i < next.size(); ++i)
              EXPECT_EQ(stored[p * block.n_history() + i], next[i]);
            history[p] = next;
          }
      }
  }

  TEST(MaterialBlock, IsSymmetricIfAllLawsAre)
  {
    struct Skew : NeoHookean
    {
      using NeoHookean::NeoHookean;
      bool
      has_symmetric_tangent() const override
      {
        return false;
      }
    };
    const NeoHookean  symmetric(relaxed);
    const Skew        skew(relaxed);
    const PlaneStress plane(std::make_unique<Skew>(relaxed));
    EXPECT_TRUE(MaterialBlock({&symmetric, &symmetric}).has_symmetric_tangents());
    EXPECT_FALSE(MaterialBlock({&symmetric, &skew}).has_symmetric_tangents());
    EXPECT_FALSE(MaterialBlock({&plane}).has_symmetric_tangents());
  }

  TEST(MaterialBlock, ReportsTheWorstPoint)
  {
    const ThreeLaws c;
    MaterialBlock   block = c.block();
    block.F[2]            = Points::diagonal(-1., 1., 1.);
    EXPECT_EQ(block.evaluate(stress_only), StepStatus::inverted_point);
  }
} // namespace
