// The run loop, with a method made up for it: cut steps, failures, what is saved and put back.

#include "made_up_method.h"

#include <gtest/gtest.h>

using namespace Stroma;

TEST(Simulation, MpiStepsToTheEnd)
{
  MadeUpMethod::start();
  const TemporaryFolder folder;
  const auto            result = run_made_up(folder);
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(result.summary.n_steps, 4u);
  EXPECT_EQ(result.summary.newton_iterations, 4u);
  EXPECT_NEAR(result.summary.results.at("sum_s2"), 4. / 16., 1e-14);
  EXPECT_EQ(result.summary.results.at("end_time_s"), 1.);
}

TEST(Simulation, MpiCutsStepsThatFail)
{
  MadeUpMethod::start();
  MadeUpMethod::orders.longest_step = .1;
  const TemporaryFolder folder;
  const auto            result = run_made_up(folder);
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(result.summary.results.at("end_time_s"), 1.);
  EXPECT_LE(result.summary.results.at("sum_s2"), .1); // no step was longer than .1 s
  EXPECT_GT(result.summary.results.at("calls"), result.summary.n_steps);
}

TEST(Simulation, MpiGivesUpBelowTheSmallestStepAndSavesTheLastState)
{
  MadeUpMethod::start();
  MadeUpMethod::orders.last_time = .6;
  const TemporaryFolder folder;
  const auto            result = run_made_up(folder);
  EXPECT_EQ(result.status, RunStatus::failed);
  EXPECT_TRUE(result.is_saved);
  EXPECT_FALSE(result.is_of_output);
  EXPECT_NE(result.summary.status.find("failed: Newton did not converge in the step from t = 0.5"), std::string::npos)
    << result.summary.status;
  // Steps of .25 s and .25 s, then such that are half as long each.
  EXPECT_GT(result.summary.results.at("end_time_s"), .599);
  EXPECT_LE(result.summary.results.at("end_time_s"), .6);
}

TEST(Simulation, MpiDoesNotCutWhatNoShorterStepCanHelp)
{
  MadeUpMethod::start();
  MadeUpMethod::orders.last_time = .6;
  MadeUpMethod::orders.failure   = StepStatus::left_grid;
  const TemporaryFolder folder;
  const auto            result = run_made_up(folder);
  EXPECT_EQ(result.status, RunStatus::failed);
  EXPECT_TRUE(result.is_saved);
  EXPECT_EQ(result.summary.results.at("calls"), 3.); // two steps and the one that failed
  EXPECT_EQ(result.summary.results.at("end_time_s"), .5);
}

TEST(Simulation, MpiAResumedRunRepeatsAnUninterruptedOne)
{
  MadeUpMethod::start();
  MadeUpMethod::orders.longest_step = .2;
  const TemporaryFolder whole, parts;
  run_made_up(whole);
  MadeUpMethod::orders.last_time = .45;
  MadeUpMethod::orders.failure   = StepStatus::left_grid;
  const auto failed              = run_made_up(parts);
  ASSERT_EQ(failed.status, RunStatus::failed);

  const auto again = run_made_up(parts, {}, true); // fails at once: what it says comes from the checkpoint
  EXPECT_EQ(again.status, RunStatus::failed);
  EXPECT_EQ(again.summary.results.at("sum_s2"), failed.summary.results.at("sum_s2"));

  MadeUpMethod::orders.last_time = 1e9;
  EXPECT_EQ(run_made_up(parts, {}, true).status, RunStatus::finished);
  EXPECT_EQ(read_text(parts / "run/series.csv"), read_text(whole / "run/series.csv"));
}

TEST(Simulation, MpiAFinishedRunStaysAsItIs)
{
  MadeUpMethod::start();
  const TemporaryFolder folder;
  const auto            first  = run_made_up(folder, {"Output/Checkpoint every=1"});
  const auto            series = read_text(folder / "run/series.csv");
  const auto            again  = run_made_up(folder, {"Output/Checkpoint every=1"}, true);
  EXPECT_EQ(again.status, RunStatus::finished);
  EXPECT_EQ(again.summary.results.at("sum_s2"), first.summary.results.at("sum_s2"));
  EXPECT_EQ(again.summary.results.at("calls"), 0.);
  EXPECT_EQ(read_text(folder / "run/series.csv"), series);
}

TEST(Simulation, MpiWritesNothingForASceneThatIsRefused)
{
  MadeUpMethod::start();
  MadeUpMethod::orders.refuses = true;
  const TemporaryFolder folder;
  EXPECT_EQ(message_of<UserError>([&] { run_made_up(folder); }), "the made-up method refuses");
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}
