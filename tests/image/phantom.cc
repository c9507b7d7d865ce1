#include <stroma/image/phantom.h>

#include "temporary_folder.h"

#include <algorithm>
#include <cmath>

using namespace Stroma::Image;

namespace
{
  PhantomSettings
  small(const unsigned int seed)
  {
    PhantomSettings settings;
    settings.size = {{96, 80, 40}};
    settings.seed = seed;
    return settings;
  }

  std::size_t
  n_vessel(const Volume<std::uint8_t> &labels)
  {
    return std::count(labels.data.begin(), labels.data.end(), 255);
  }

  /// Mean length of the runs of vessel voxels along x [voxels]: about two radii for tubes in random directions.
  double
  mean_chord(const Volume<std::uint8_t> &labels)
  {
    std::size_t n_runs = 0;
    for (std::size_t i = 0; i < labels.data.size(); ++i)
      n_runs += labels.data[i] && (i % labels.size[0] == 0 || !labels.data[i - 1]);
    return double(n_vessel(labels)) / n_runs;
  }

  struct Statistics
  {
    double mean = 0, deviation = 0;
  };

  /// Grey values where the label is `label`.
  Statistics
  statistics(const Phantom &phantom, const std::uint8_t label)
  {
    double n = 0, sum = 0, sum_of_squares = 0;
    for (std::size_t i = 0; i < phantom.image.data.size(); ++i)
      if (phantom.labels.data[i] == label)
        {
          const double value = phantom.image.data[i];
          ++n, sum += value, sum_of_squares += value * value;
        }
    return {sum / n, std::sqrt(sum_of_squares / n - sum * sum / n / n)};
  }
} // namespace

TEST(Phantom, ReachesTheVesselFractionExactly)
{
  for (const double fraction : {0.001, 0.104, 0.5})
    {
      auto settings            = small(3);
      settings.vessel_fraction = fraction;
      const auto labels        = make_phantom(settings).labels;
      EXPECT_EQ(n_vessel(labels), std::size_t(std::llround(fraction * labels.n_voxels())));
      EXPECT_EQ(labels.n_voxels(), n_vessel(labels) + std::count(labels.data.begin(), labels.data.end(), 0));
    }
}

TEST(Phantom, SeedDecides)
{
  const auto one = make_phantom(small(1)), again = make_phantom(small(1)), other = make_phantom(small(2));
  EXPECT_EQ(one.labels.data, again.labels.data);
  EXPECT_EQ(one.image.data, again.image.data);
  EXPECT_NE(one.labels.data, other.labels.data);
}

TEST(Phantom, TubesHaveTheRadius)
{
  PhantomSettings settings;
  settings.size            = {{200, 200, 60}};
  settings.vessel_fraction = 0.06;
  for (const double radius : {3., 6.})
    {
      settings.radius    = radius * 1e-6;
      const double chord = mean_chord(make_phantom(settings).labels);
      EXPECT_GT(chord, 1.6 * radius);
      EXPECT_LT(chord, 3.2 * radius);
    }
}

TEST(Phantom, RadiusIsALengthNotAVoxelNumber)
{
  auto coarse       = small(5);
  coarse.voxel_size = {{2e-6, 2e-6, 2e-6}};
  coarse.radius     = 6e-6;
  coarse.blur       = 2e-6;
  EXPECT_EQ(make_phantom(coarse).labels.data, make_phantom(small(5)).labels.data);
}

TEST(Phantom, Slice)
{
  auto settings            = small(4);
  settings.size            = {{256, 256, 1}};
  settings.voxel_size[2]   = 5e-6;
  settings.vessel_fraction = 0.19;
  const auto phantom       = make_phantom(settings);
  EXPECT_EQ(n_vessel(phantom.labels), 12452u);
  EXPECT_GT(statistics(phantom, 255).mean, statistics(phantom, 0).mean + 80);
}

TEST(Phantom, WithoutBlurAndNoiseTheImageIsTheLabels)
{
  auto settings      = small(6);
  settings.blur      = 0;
  settings.noise     = 0;
  const auto phantom = make_phantom(settings);
  EXPECT_EQ(statistics(phantom, 255).mean, vessel_value);
  EXPECT_EQ(statistics(phantom, 255).deviation, 0);
  EXPECT_EQ(statistics(phantom, 0).mean, background_value);
}

TEST(Phantom, NoiseHasItsSizeAndGrowsWithBrightness)
{
  auto settings           = small(7);
  settings.blur           = 0;
  settings.noise          = 0.1;
  const auto   phantom    = make_phantom(settings);
  const double in_vessels = 0.1 * (vessel_value - background_value);
  EXPECT_NEAR(statistics(phantom, 255).mean, vessel_value, 0.3);
  EXPECT_NEAR(statistics(phantom, 255).deviation, in_vessels, 0.02 * in_vessels);
  const double in_background = in_vessels * std::sqrt(background_value / vessel_value);
  EXPECT_NEAR(statistics(phantom, 0).deviation, in_background, 0.02 * in_background);
}

TEST(Phantom, BlurKeepsTheBrightnessAndWidensEdges)
{
  auto settings          = small(8);
  settings.noise         = 0;
  settings.blur          = 0;
  const auto sharp       = make_phantom(settings).image;
  settings.blur          = 1.5e-6;
  const auto   blurred   = make_phantom(settings).image;
  const double n         = sharp.n_voxels();
  double       sharp_sum = 0, blurred_sum = 0;
  std::size_t  n_between = 0;
  for (std::size_t i = 0; i < sharp.data.size(); ++i)
    {
      sharp_sum += sharp.data[i];
      blurred_sum += blurred.data[i];
      n_between += blurred.data[i] > background_value + 5 && blurred.data[i] < vessel_value - 5;
    }
  EXPECT_NEAR(blurred_sum / n, sharp_sum / n, 0.5);
  EXPECT_GT(n_between, 0.1 * n);
}

TEST(Phantom, RefusesWrongSettings)
{
  const auto expect = [](void (*change)(PhantomSettings &), const std::string &what) {
    PhantomSettings settings;
    change(settings);
    expect_user_error([&] { make_phantom(settings); }, "Phantom", what);
  };
  expect([](PhantomSettings &s) { s.size[1] = 0; }, "size 0");
  expect([](PhantomSettings &s) { s.voxel_size[0] = -1; }, "voxel size");
  expect([](PhantomSettings &s) { s.vessel_fraction = 0; }, "(0, 0.5]");
  expect([](PhantomSettings &s) { s.vessel_fraction = 0.6; }, "0.6");
  expect([](PhantomSettings &s) { s.radius = 0.4e-6; }, "radius");
  expect([](PhantomSettings &s) { s.blur = -1e-6; }, "blur");
  expect([](PhantomSettings &s) { s.noise = std::nan(""); }, "noise");
}
