// First guesses of solves from those before.

#include <stroma/sph/solve_history.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace Stroma;
using dealii::Tensor;

namespace
{
  constexpr unsigned int n = 50;

  /// Forces that fade, each with a time of its own, and the solution of A v = f, A diagonal; both with noise.
  std::vector<Tensor<1, 2>>
  fading(const double t, const bool solved, const double noise)
  {
    std::vector<Tensor<1, 2>> field(n);
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int c = 0; c < 2; ++c)
        field[i][c] = (std::exp(-t * (.2 + .01 * i)) + noise * std::sin(1e3 * (i + .3 * c + 7. * t))) /
                      (solved ? 1. + i : 1.);
    return field;
  }

  double
  error_of_guess(const double noise, const double tolerance)
  {
    Sph::SolveHistory<2> history(MPI_COMM_SELF);
    for (const double t : {0., .1, .2, .3, .4, .5})
      history.add(fading(t, true, noise), fading(t, false, 0.), 1);
    auto       v     = fading(0., true, 0.);
    const auto exact = fading(.6, true, 0.);
    EXPECT_TRUE(history.guess(v, fading(.6, false, 0.), tolerance, 1));
    double error = 0.;
    for (unsigned int i = 0; i < n; ++i)
      error = std::max(error, (v[i] - exact[i]).norm());
    return error;
  }
} // namespace

TEST(SolveHistory, GuessesWhatFadesSmoothly)
{
  EXPECT_LT(error_of_guess(0., 1e-9), 1e-5);
}

TEST(SolveHistory, DoesNotBringInTheErrorsOfSolves)
{
  // The combination that fits best without a look at errors has coefficients of hundreds.
  EXPECT_LT(error_of_guess(1e-4, 1e-4), 4e-4);
  EXPECT_GT(error_of_guess(1e-4, 1e-12), error_of_guess(1e-4, 1e-4));
}

TEST(SolveHistory, KnowsNothingOfAnotherOrder)
{
  Sph::SolveHistory<2> history(MPI_COMM_SELF);
  auto                 v = fading(0., true, 0.);
  const auto           f = fading(0., false, 0.), before = v;
  EXPECT_FALSE(history.guess(v, f, 1e-6, 1));
  history.add(v, f, 1);
  EXPECT_FALSE(history.guess(v, f, 1e-6, 2));
  EXPECT_EQ(v, before);
  EXPECT_TRUE(history.guess(v, f, 1e-6, 1));
  for (unsigned int i = 0; i < n; ++i)
    EXPECT_NEAR(v[i][0], before[i][0], 1e-10);
}
