#include "../world.h"

#include <stroma/output/remote_places.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace Stroma::Output;

namespace
{
  namespace mpi = dealii::Utilities::MPI;
  /// Rank r knows x in [r, r + 1] and tells (x^2, r).
  struct Known
  {
    Extent       extent;
    unsigned int rank = mpi::this_mpi_process(world), n_ranks = mpi::n_mpi_processes(world);

    Known()
    {
      extent.add({{double(rank), 0., 0.}});
      extent.add({{rank + 1., 1., 0.}});
    }

    Samples
    ask(const WhoKnows &who, const std::function<Rating(const Place &)> &rate) const
    {
      Samples samples;
      for (double x = -.25; x < n_ranks + .5; x += .25)
        samples.X.push_back({{x, .5, 0.}});
      ask_ranks(
        samples, 2, who,
        [&](const Place &X, double *values) {
          values[0] = X[0] * X[0];
          values[1] = rank;
          return rate(X);
        },
        world);
      return samples;
    }
  };
} // namespace

TEST(RemotePlaces, MpiTheRankThatKnowsAnswers)
{
  const Known known;
  const auto  samples = known.ask(ranks_within(known.extent, 0., world), [](const Place &) { return Rating(0); });
  for (std::size_t i = 0; i < samples.X.size(); ++i)
    {
      const double x = samples.X[i][0];
      ASSERT_EQ(samples.found[i], x >= 0. && x <= known.n_ranks) << x;
      EXPECT_EQ(samples.values[2 * i], samples.found[i] ? x * x : 0.);
      if (samples.found[i]) // where two know, the lower one
        {
          EXPECT_EQ(samples.values[2 * i + 1], std::max(0., std::ceil(x) - 1.)) << x;
        }
    }
}

TEST(RemotePlaces, MpiTheBestRatingWins)
{
  const Known known;
  const auto  samples = known.ask(ranks_within(known.extent, 0., world),
                                  [&](const Place &) { return Rating(known.n_ranks - known.rank); });
  for (std::size_t i = 0; i < samples.X.size(); ++i)
    if (samples.found[i])
      {
        EXPECT_EQ(samples.values[2 * i + 1], std::min(std::floor(samples.X[i][0]), known.n_ranks - 1.))
          << samples.X[i][0];
      }
}

TEST(RemotePlaces, MpiOnlyWhoMayKnowIsAsked)
{
  const Known  known;
  unsigned int asked   = 0;
  const auto   rank_0  = [](const Place &X) { return std::vector<unsigned int>(X[0] > 0. ? 1 : 0, 0u); };
  const auto   samples = known.ask(rank_0, [&](const Place &X) {
    EXPECT_GT(X[0], 0.);
    ++asked;
    return X[0] < .3 ? knows_not : Rating(0);
  });
  EXPECT_EQ(asked, known.rank == 0 ? known.n_ranks * (samples.X.size() - 2) : 0);
  for (std::size_t i = 0; i < samples.X.size(); ++i)
    {
      EXPECT_EQ(samples.found[i], samples.X[i][0] > .3);
      EXPECT_EQ(samples.values[2 * i + 1], 0.);
    }
}
