#include "../output/temporary_folder.h"
#include "../world.h"

#include <stroma/base/errors.h>
#include <stroma/output/collective.h>
#include <stroma/studies/reference_file.h>
#include <stroma/studies/run_record.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace Stroma;
using namespace Stroma::Studies;

namespace
{
  /// Two times, three points (other ones at the second time) and a line of two places; the last point is not covered.
  Comparison
  example()
  {
    Comparison comparison;
    comparison.b           = "run fine";
    comparison.frame       = {"A block", 2, {{0, 0, 0}}, {{2, 1, 0}}, {"gel", "stiff gel"}};
    comparison.times       = {.5, 1.};
    comparison.kept.fields = {{"displacement_m", 2}, {"pressure_Pa", 1}};
    for (const double t : comparison.times)
      {
        PlaceSet points{"points", {}}, line{"0, 0 : 1, 0", {}};
        points.samples.X        = {{{t, .1, 0}}, {{.2, .3, 0}}, {{.4, .5, 0}}};
        points.samples.weight   = {1, 2, 3};
        points.samples.material = {0, 1, 0};
        points.samples.values   = {t, 2, 3, 4, 5, 6, std::nan(""), std::nan(""), std::nan("")};
        line.samples.X          = {{{0, 0, 0}}, {{1, 0, 0}}};
        line.samples.values     = {t, 1, 10, 2, 3, 20};
        if (dealii::Utilities::MPI::this_mpi_process(world) > 0) // all of it is on rank 0
          points.samples = line.samples = {};
        comparison.kept.places.push_back({points, line});
      }
    return comparison;
  }
} // namespace

TEST(ReferenceFile, MpiRoundTrip)
{
  const TemporaryFolder folder;
  const auto            comparison = example();
  write_reference(folder / "reference.h5", comparison, world);
  ReferenceSource source(folder / "reference.h5", world);
  EXPECT_EQ(source.times(), comparison.times);
  EXPECT_EQ(source.frame().difference_from(comparison.frame), "");
  EXPECT_EQ(names_of(source.fields()), (std::vector<std::string>{"displacement_m", "pressure_Pa"}));
  auto sets = source.own_places(1.);
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[0].samples.X, comparison.kept.places[1][0].samples.X);
  EXPECT_EQ(sets[0].samples.weight, comparison.kept.places[1][0].samples.weight);
  EXPECT_EQ(sets[0].samples.material, comparison.kept.places[1][0].samples.material);
  EXPECT_EQ(source.own_places(.5)[1].samples.X, sets[1].samples.X);

  source.sample({"pressure_Pa", "displacement_m"}, .5, sets[1]);
  EXPECT_EQ(Output::gather_all(sets[1].samples.values, world), (std::vector<double>{10, .5, 1, 20, 2, 3}));
  source.sample({"pressure_Pa"}, 1., sets[0]);
  const auto pressures = Output::gather_all(sets[0].samples.values, world);
  EXPECT_EQ(pressures[1], 6.);
  EXPECT_TRUE(std::isnan(pressures[2]));
}

/// What one rank has written, others take up in shares.
TEST(ReferenceFile, MpiPlacesAreSharedOut)
{
  const TemporaryFolder folder;
  const auto            comparison = example();
  if (dealii::Utilities::MPI::this_mpi_process(world) == 0)
    write_reference(folder / "reference.h5", comparison, MPI_COMM_SELF);
  MPI_Barrier(world);
  ReferenceSource source(folder / "reference.h5", world);
  const auto      points  = source.own_places(1.)[0];
  const auto      n_ranks = dealii::Utilities::MPI::n_mpi_processes(world);
  EXPECT_LE(points.samples.X.size(), (3 + n_ranks - 1) / n_ranks);
  EXPECT_EQ(points.samples.values.size(), 3 * points.samples.X.size());
  EXPECT_EQ(Output::gather_all(points.samples.weight, world), (std::vector<double>{1, 2, 3}));
}

TEST(ReferenceFile, MpiOtherFilesAreRefused)
{
  const TemporaryFolder folder;
  put_text(folder / "text.h5", "no reference");
  EXPECT_EQ(message_of<UserError>([&] { ReferenceSource(folder / "text.h5", world); }),
            (folder / "text.h5") + ": this is not a reference that 'stroma compare --save' wrote");
}

TEST(SceneFrame, SaysWhatDiffers)
{
  const SceneFrame a = example().frame;
  SceneFrame       b = a;
  b.upper[0] += 1e-7;
  EXPECT_EQ(b.difference_from(a), "");
  b.upper[0] = 3;
  EXPECT_EQ(b.difference_from(a), "has bodies from (0, 0) to (3, 1) m instead of (0, 0) to (2, 1) m");
  b.materials = {"gel"};
  EXPECT_EQ(b.difference_from(a), "has the materials gel instead of gel, stiff gel");
  b.dimension = 3;
  EXPECT_EQ(b.difference_from(a), "has dimension 3 instead of 2");
}

TEST(RunRecord, MpiRoundTripAndDamage)
{
  const TemporaryFolder folder;
  Output::Summary       summary;
  summary.status             = "finished";
  summary.n_steps            = 7;
  summary.wall_time_s        = 1. / 3.;
  summary.results["force_N"] = .1;
  summary.results["none"]    = std::nan("");
  RunResult result;
  result.summary    = summary;
  result.cpu_time_s = 5. / 3.;
  RunRecord record("set A = 1", result);
  record.wall_times.push_back(2. / 3.);
  record.errors["displacement_m"] = {{1e-3, std::nan(""), 2e-3}};
  EXPECT_EQ(RunRecord::read(folder.path, world).status, "");
  record.write(folder.path, world);
  const auto read = RunRecord::read(folder.path, world);
  EXPECT_TRUE(read.finished());
  EXPECT_EQ(read.parameters, "set A = 1");
  EXPECT_EQ(read.n_steps, 7u);
  EXPECT_EQ(read.wall_times, record.wall_times);
  EXPECT_EQ(read.cpu_times, std::vector<double>{5. / 3.});
  EXPECT_EQ(read.results.at("force_N"), .1);
  EXPECT_TRUE(std::isnan(read.results.at("none")));
  EXPECT_EQ(read.errors.at("displacement_m")[2], 2e-3);
  EXPECT_TRUE(std::isnan(read.errors.at("displacement_m")[1]));
  put_text(folder / RunRecord::file_name, "{ \"status\": \"finished\"");
  EXPECT_EQ(RunRecord::read(folder.path, world).status, "");
}
