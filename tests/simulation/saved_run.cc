#include "made_up_method.h"

#include <stroma/simulation/saved_run.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  /// The made-up method's number at @p time.
  double
  sum_at(SavedRun &run, const double time)
  {
    Output::Samples samples;
    samples.X = {{}};
    run.at(time).state(false)->sample({2, {"displacement"}}, samples);
    return samples.values.at(0);
  }
} // namespace

TEST(SavedRun, MpiIsTheRunAtEachTimeInAnyOrder)
{
  MadeUpMethod::start();
  const TemporaryFolder folder;
  run_made_up(folder, {"Output/Keep states=true", "Output/Fields every=1"});
  SavedRun    run(folder / "run", MPI_COMM_WORLD);
  const auto *scene = &run.scene<2>();
  EXPECT_EQ(run.times(), (std::vector<double>{.25, .5, .75, 1.}));
  EXPECT_EQ(run.facts().sampled_fields, (std::vector<std::string>{"displacement"}));
  for (const double time : {.5, 1., .25})
    EXPECT_NEAR(sum_at(run, time), .25 * time, 1e-14);
  EXPECT_EQ(&run.scene<2>(), scene); // read once
  EXPECT_EQ(scene->bounding_box().side_length(0), 2.);
}

TEST(SavedRun, MpiWithoutStatesIsRefused)
{
  MadeUpMethod::start();
  const TemporaryFolder folder;
  run_made_up(folder);
  EXPECT_NE(message_of<UserError>([&] { SavedRun(folder / "run", MPI_COMM_WORLD); }).find("the run kept no states"),
            std::string::npos);
}
