// The direction of a migration as a function of time alone: its law, and that nothing else counts.

#include <stroma/processes/ornstein_uhlenbeck.h>

#include <gtest/gtest.h>

#include <cmath>

using Stroma::Processes::OrnsteinUhlenbeck;

namespace
{
  constexpr double       k = .1, D = 5e-5;
  constexpr unsigned int n_paths = 20000;

  /// Mean over paths of the product of X at two times.
  double
  mean_of_products(const double rate, const double s, const double t)
  {
    double sum = 0.;
    for (unsigned int seed = 0; seed < n_paths; ++seed)
      {
        const OrnsteinUhlenbeck path(rate, D, seed, 0);
        sum += path.at(s) * path.at(t);
      }
    return sum / n_paths;
  }
} // namespace

TEST(OrnsteinUhlenbeck, CovariancesAreThoseOfTheLaw)
{
  // Within an interval of knots (10 s apart), across one, and far from the start.
  for (const auto &[s, t] : {std::pair(3., 3.), {3., 7.1}, {3., 14.}, {31.3, 33.7}, {58.2, 58.3}})
    {
      const double exact = D / k * (std::exp(-k * (t - s)) - std::exp(-k * (t + s)));
      EXPECT_NEAR(mean_of_products(k, s, t) / exact, 1.,
                  5. / std::sqrt(n_paths) * std::sqrt(2.) / std::exp(-k * (t - s)))
        << s << " and " << t;
    }
}

TEST(OrnsteinUhlenbeck, WithoutARateItIsABrownianMotion)
{
  for (const auto &[s, t] : {std::pair(.3, .3), {.3, .7}, {1.5, 9.2}})
    EXPECT_NEAR(mean_of_products(0., s, t) / (2. * D * s), 1., 5. * std::sqrt(2. * t / s / n_paths))
      << s << " and " << t;
}

TEST(OrnsteinUhlenbeck, ItIsAFunctionOfTimeAlone)
{
  const OrnsteinUhlenbeck forward(k, D, 7, 0), backward(k, D, 7, 0), other(k, D, 8, 0), across(k, D, 7, 1);
  for (int i = 999; i >= 0; --i)
    backward.at(.6 * i);
  for (unsigned int i = 1; i < 1000; ++i)
    {
      EXPECT_EQ(forward.at(.6 * i), backward.at(.6 * i));
      EXPECT_NE(forward.at(.6 * i), other.at(.6 * i));
      EXPECT_NE(forward.at(.6 * i), across.at(.6 * i));
    }
  EXPECT_EQ(forward.at(0.), 0.);
}

TEST(OrnsteinUhlenbeck, ItIsContinuous)
{
  const OrnsteinUhlenbeck path(k, D, 3, 0);
  for (unsigned int i = 0; i < 1000; ++i)
    {
      const double t = .37 * i, h = 1e-3;
      EXPECT_LT(std::abs(path.at(t + h) - path.at(t)), 6. * std::sqrt(2. * D * h));
    }
  for (const double t : {10., 20., 5., 12.5}) // of knots and middles
    EXPECT_NEAR(path.at(t - 1e-9), path.at(t + 1e-9), 1e-5);
}
