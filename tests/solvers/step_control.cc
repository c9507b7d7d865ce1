#include <stroma/base/parameters.h>
#include <stroma/solvers/step_control.h>

#include <gtest/gtest.h>

#include <vector>

using namespace Stroma;
using namespace Stroma::Solvers;

namespace
{
  StepSettings
  make_settings(const double end, const double initial, const double smallest, const double largest)
  {
    StepSettings settings;
    settings.end_time      = end;
    settings.initial_step  = initial;
    settings.smallest_step = smallest;
    settings.largest_step  = largest;
    return settings;
  }

  /// Times passed if every step takes the same number of Newton iterations.
  std::vector<double>
  times(StepControl &control, const double end, const unsigned int newton_iterations)
  {
    std::vector<double> all;
    for (double t = 0.; t < end && all.size() < 1000;)
      {
        t = control.next(t);
        control.accept(newton_iterations);
        all.push_back(t);
      }
    return all;
  }
} // namespace

TEST(StepControl, KeepsEqualSteps)
{
  StepControl control(make_settings(1., .1, 1e-3, .1));
  const auto  all = times(control, 1., 6);
  ASSERT_EQ(all.size(), 10);
  for (unsigned int i = 0; i < 10; ++i)
    EXPECT_NEAR(all[i], .1 * (i + 1), 1e-14);
  EXPECT_EQ(all.back(), 1.);
}

TEST(StepControl, DoublesAfterEasyStepsUpToTheLargest)
{
  StepControl control(make_settings(2., .125, 1e-3, .5));
  EXPECT_EQ(times(control, 2., 4), (std::vector<double>{.125, .375, .875, 1.375, 1.6875, 2.}));
}

TEST(StepControl, HalvesAfterHardSteps)
{
  StepControl control(make_settings(1., .5, .125, .5));
  EXPECT_EQ(times(control, 1., 13), (std::vector<double>{.5, .75, .875, 1.}));
}

TEST(StepControl, KeepsTheStepBetweenEasyAndHard)
{
  for (const unsigned int newton_iterations : {5, 12})
    {
      StepControl control(make_settings(1., .25, 1e-3, 1.));
      EXPECT_EQ(times(control, 1., newton_iterations), (std::vector<double>{.25, .5, .75, 1.}));
    }
}

TEST(StepControl, LeavesNoSliverBeforeATime)
{
  StepControl control(make_settings(1., .5, 1e-3, .5), {.51});
  EXPECT_EQ(control.next(0.), .255);
  EXPECT_EQ(control.next(.255), .51);
}

TEST(StepControl, MeetsGivenTimesExactlyAndGoesOnWithItsStep)
{
  const double third = 1. / 3.;
  StepControl  control(make_settings(1., .25, 1e-3, .25), {.7, third, third + 1e-15, -1., 5., 1.});
  const auto   all = times(control, 1., 6);
  ASSERT_EQ(all.size(), 6);
  EXPECT_EQ(all[1], third);
  EXPECT_EQ(all[3], .7);
  EXPECT_EQ(all[5], 1.);
}

TEST(StepControl, AStubBeforeAGivenTimeDoesNotShortenTheStep)
{
  StepControl control(make_settings(1., .25, 1e-3, .5), {.0625});
  EXPECT_EQ(control.next(0.), .0625);
  control.accept(1);
  EXPECT_EQ(control.next(.0625), .3125);
  control.accept(1);
  EXPECT_EQ(control.next(.3125), .65625); // .5 would leave less than another step: two halves
}

TEST(StepControl, RejectionHalvesUntilTheSmallest)
{
  StepControl control(make_settings(1., .4, .1, .4));
  EXPECT_EQ(control.next(0.), .4);
  EXPECT_TRUE(control.reject());
  EXPECT_EQ(control.next(0.), .2);
  EXPECT_TRUE(control.reject());
  EXPECT_EQ(control.next(0.), .1);
  EXPECT_FALSE(control.reject());
}

TEST(StepControl, RejectionOfAStubHalvesTheStub)
{
  StepControl control(make_settings(1., .4, .01, .4), {.1});
  EXPECT_EQ(control.next(0.), .1);
  EXPECT_TRUE(control.reject());
  EXPECT_EQ(control.next(0.), .05);
}

TEST(StepControl, GoesOnFromASavedState)
{
  const auto  settings = make_settings(1., .1, 1e-3, 1.);
  StepControl first(settings), second(settings);
  double      t = first.next(0.);
  first.accept(3);
  second.load(first.save());
  EXPECT_EQ(first.next(t), second.next(t));
  EXPECT_NEAR(second.next(t), .3, 1e-15);
}

TEST(StepSettings, DefaultStepsFollowTheEnd)
{
  const auto   file = ParameterFile::parse("subsection Time\n set End = 20\nend\n", "test.prm");
  Parameters   p(file);
  StepSettings settings;
  {
    const auto section = p.section("Time");
    settings.add(p);
  }
  p.finish();
  EXPECT_DOUBLE_EQ(settings.initial_step, 2.);
  EXPECT_DOUBLE_EQ(settings.smallest_step, 2e-5);
  EXPECT_DOUBLE_EQ(settings.largest_step, 20.);
}

TEST(StepSettings, ContradictionsAreErrors)
{
  for (const char *const entries : {"set Smallest step = .2", "set Largest step = .05", "set Easy iterations = 20"})
    {
      const auto   file = ParameterFile::parse(entries, "test.prm");
      Parameters   p(file);
      StepSettings settings;
      try
        {
          settings.add(p);
          ADD_FAILURE() << entries;
        }
      catch (const UserError &error)
        {
          EXPECT_NE(std::string(error.what()).find("test.prm:1: "), std::string::npos) << error.what();
        }
    }
}
