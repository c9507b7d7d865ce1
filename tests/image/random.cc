#include <stroma/image/random.h>

#include <gtest/gtest.h>

using Stroma::Image::Random;

// The first output of std::mt19937_64 with its default seed is 14514284786278117030 (C++ standard, 10000th:
// 9981545732273789042), so the first uniform draw is known.
TEST(Random, UniformIsTheEngineOverTwoToThe64)
{
  Random random(5489);
  EXPECT_DOUBLE_EQ(random.uniform(), 14514284786278117030. / 18446744073709551616.);
  for (unsigned int i = 1; i < 9999; ++i)
    random.uniform();
  EXPECT_DOUBLE_EQ(random.uniform(), 9981545732273789042. / 18446744073709551616.);
}

TEST(Random, NormalHasItsMoments)
{
  Random           random(1);
  constexpr double n      = 400000;
  double           sum[5] = {};
  for (unsigned int i = 0; i < n; ++i)
    {
      const double x = random.normal();
      for (unsigned int k = 1; k <= 4; ++k)
        sum[k] += std::pow(x, k) / n;
    }
  EXPECT_NEAR(sum[1], 0, 0.007);
  EXPECT_NEAR(sum[2], 1, 0.01);
  EXPECT_NEAR(sum[3], 0, 0.03);
  EXPECT_NEAR(sum[4], 3, 0.08);
}
