#include <stroma/studies/norms.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

using namespace Stroma::Studies;

namespace
{
  std::vector<std::size_t>
  first(const std::size_t n)
  {
    std::vector<std::size_t> places(n);
    std::iota(places.begin(), places.end(), 0);
    return places;
  }
} // namespace

TEST(Norms, L2IsWeightedByVolumeAndRelativeToB)
{
  // |A - B| = 5, 0; |B| = 1, 2; volumes 4, 1.
  const FieldPair field{"displacement_m", 2, {3, 5, 0, 2}, {0, 1, 0, 2}};
  const Norm      norm = l2_norm(field, {4, 1}, first(2));
  EXPECT_DOUBLE_EQ(norm.difference, std::sqrt(4 * 25.));
  EXPECT_DOUBLE_EQ(norm.reference, std::sqrt(4 * 1. + 1 * 4.));
  EXPECT_DOUBLE_EQ(norm.relative(), 10 / std::sqrt(8.));
}

TEST(Norms, OnlyTheGivenPlacesCount)
{
  const FieldPair field{"pressure_Pa", 1, {1, 100, 3}, {2, 1, 5}};
  EXPECT_DOUBLE_EQ(l2_norm(field, {1, 1, 1}, {0, 2}).difference, std::sqrt(1. + 4.));
  EXPECT_DOUBLE_EQ(max_norm(field, {0, 2}).difference, 2.);
  EXPECT_DOUBLE_EQ(max_norm(field, {0, 2}).reference, 5.);
}

TEST(Norms, MaximumOfVectorsIsThatOfTheirLengths)
{
  const FieldPair field{"displacement_m", 2, {3, 4, 0, 0}, {0, 0, 0, -2}};
  EXPECT_DOUBLE_EQ(max_norm(field, first(2)).difference, 5.);
  EXPECT_DOUBLE_EQ(max_norm(field, first(2)).reference, 2.);
}

TEST(Norms, LinearFieldOnALatticeHasItsIntegral)
{
  // u = x on [0, 1] against 0.5: the integral of (x - 1/2)^2 is 1/12, by the midpoint rule (1 - 1/n^2)/12.
  const unsigned int n = 50;
  FieldPair          field{"displacement_m", 1, {}, {}};
  for (unsigned int i = 0; i < n; ++i)
    {
      field.a.push_back((i + .5) / n);
      field.b.push_back(.5);
    }
  const Norm norm = l2_norm(field, std::vector<double>(n, 1. / n), first(n));
  EXPECT_NEAR(norm.difference, std::sqrt((1 - 1. / (n * n)) / 12), 1e-14);
  EXPECT_NEAR(norm.reference, .5, 1e-14);
}

TEST(Norms, ShearStressesCountTwice)
{
  const FieldPair stress{"cauchy_stress_Pa", 6, {1, 0, 0, 2, 0, 0}, {0, 0, 0, 0, 0, 3}};
  EXPECT_DOUBLE_EQ(stress.size_of_a(0), std::sqrt(1 + 2 * 4.));
  EXPECT_DOUBLE_EQ(stress.size_of_b(0), std::sqrt(2 * 9.));
}

TEST(Norms, RelativeToNothingIsNoNumber)
{
  const FieldPair nothing{"pressure_Pa", 1, {0}, {0}}, zero{"pressure_Pa", 1, {1}, {0}};
  EXPECT_TRUE(std::isnan(l2_norm(nothing, {1}, {0}).relative()));
  EXPECT_TRUE(std::isinf(l2_norm(zero, {1}, {0}).relative()));
}

TEST(Norms, ObservedOrder)
{
  EXPECT_NEAR(observed_order(8, 1e-2, 16, 2.5e-3), 2., 1e-14); // numbers of cells
  EXPECT_NEAR(observed_order(.1, 1e-2, .05, 5e-3), 1., 1e-14); // steps
  EXPECT_NEAR(observed_order(8, 1e-2, 16, 4e-2), -2., 1e-14);  // grows
  EXPECT_TRUE(std::isnan(observed_order(8, 0., 16, 1e-3)));
  EXPECT_TRUE(std::isnan(observed_order(8, 1e-2, 8, 1e-3)));
  EXPECT_TRUE(std::isnan(observed_order(std::nan(""), 1e-2, 16, 1e-3)));
}

TEST(Norms, MedianAndSpread)
{
  EXPECT_DOUBLE_EQ(median({3, 1, 2}), 2.);
  EXPECT_DOUBLE_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_DOUBLE_EQ(spread({3, 1, 2}), 2.);
  EXPECT_TRUE(std::isnan(median({})));
}
