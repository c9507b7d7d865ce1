#include <stroma/sph/velocity_history.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using History    = Stroma::Sph::VelocityHistory<2>;
  using Velocities = History::Velocities;

  /// Of two particles at time @p t.
  template <typename Function>
  Velocities
  velocities(const Function &at, const double t)
  {
    Velocities v(2);
    v[0][0] = at(t);
    v[1][1] = -2. * at(t);
    return v;
  }

  /// Where a history of steps of unequal length guesses to be after one more; @p order is that of the particles then.
  template <typename Function>
  std::pair<double, double>
  guess_and_truth(const Function &at, const unsigned int n_steps, const unsigned int order = 1)
  {
    History history;
    double  t = 0.;
    for (unsigned int k = 0; k < n_steps; ++k)
      {
        const double dt = .1 + .02 * (k % 3);
        history.add(velocities(at, t), velocities(at, t + dt), 2, dt, 1, MPI_COMM_SELF);
        t += dt;
      }
    auto v = velocities(at, t);
    history.extrapolate(v, 2, .13, order);
    EXPECT_DOUBLE_EQ(v[1][1], -2. * v[0][0]);
    return {v[0][0], at(t + .13)};
  }
} // namespace

TEST(VelocityHistory, FollowsACubicOverUnequalSteps)
{
  const auto [guess, truth] = guess_and_truth([](const double t) { return 1. - t + 2. * t * t - 3. * t * t * t; }, 6);
  EXPECT_NEAR(guess, truth, 1e-12);
}

TEST(VelocityHistory, StaysNearTheLastVelocitiesWhereTheyJump)
{
  // Any number from 0 to 1 in each step.
  const auto jumps = [](const double t) { return std::fmod(std::abs(std::sin(1e3 * t * t) * 43758.5453), 1.); };
  double     way = 0., t = 0.; // sum of distances from the last velocity
  for (unsigned int n = 0; n < 14; ++n)
    {
      if (n >= 6)
        way += std::abs(guess_and_truth(jumps, n).first - jumps(t));
      t += .1 + .02 * (n % 3);
    }
  EXPECT_LT(way, 6.); // 2.9; with degree 3 throughout 18.3
}

TEST(VelocityHistory, KnowsNothingOfAnotherOrderNorOfTheStart)
{
  const auto line = [](const double t) { return t; };
  EXPECT_NEAR(guess_and_truth(line, 6, 2).first, guess_and_truth(line, 6).first - .13, 1e-12);
  const auto [guess, truth] = guess_and_truth(line, 1); // the only state before is that of the start
  EXPECT_NEAR(guess, truth - .13, 1e-12);
}

TEST(VelocityHistory, ErrorsDoNotGrowAfterAShortStep)
{
  for (const double dt : {1e-3, 1e-9})
    {
      History history;
      double  t = 0., error = 1e-6;
      for (const double step : {.1, .1, .1, dt})
        {
          const auto now = velocities([&](double) { return 1. + error; }, t);
          error          = -error;
          history.add(Velocities(now), velocities([&](double) { return 1. + error; }, t), 2, step, 1, MPI_COMM_SELF);
          t += step;
        }
      auto v = velocities([&](double) { return 1. + error; }, t);
      history.extrapolate(v, 2, .1, 1);
      EXPECT_NEAR(v[0][0], 1., 1e-4) << dt;
    }
}
