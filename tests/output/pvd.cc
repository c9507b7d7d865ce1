#include "../world.h"
#include "temporary_folder.h"

#include <stroma/base/output_error.h>
#include <stroma/output/pvd.h>

#include <gtest/gtest.h>

using namespace Stroma;
using namespace Stroma::Output;

namespace
{
  using Entries = std::vector<std::pair<double, std::string>>;
} // namespace

TEST(PvdSeries, MpiHoldsAllEntriesAfterEachAddition)
{
  const TemporaryFolder folder;
  PvdSeries             series(folder / "points.pvd", world);
  series.add(0., "points_0000.pvtu");
  const std::string first = read_text(folder / "points.pvd");
  EXPECT_NE(first.find("timestep=\"0\""), std::string::npos);
  EXPECT_NE(first.find("</VTKFile>"), std::string::npos);
  MPI_Barrier(world);
  series.add(0.1, "points_0001.pvtu");
  const std::string second = read_text(folder / "points.pvd");
  EXPECT_NE(second.find("timestep=\"0.1\" group=\"\" part=\"0\" file=\"points_0001.pvtu\""), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "points.pvd.tmp"));
}

TEST(PvdSeries, MpiRestoreDropsLaterEntries)
{
  const TemporaryFolder folder;
  for (const std::string name : {"points.pvd", "points.xdmf"})
    {
      PvdSeries series(folder / name, world);
      for (unsigned int i = 0; i < 5; ++i)
        series.add(0.1 * i, "r" + std::to_string(i));

      PvdSeries resumed(folder / name, world);
      resumed.restore(0.1 * 3); // not 0.3 exactly
      resumed.add(0.35, "r4");
      const Entries expected = {{0., "r0"}, {0.1, "r1"}, {0.2, "r2"}, {0.1 * 3, "r3"}, {0.35, "r4"}};
      if (folder.is_first())
        {
          EXPECT_EQ(resumed.entries(), expected) << name;
        }

      PvdSeries again(folder / name, world);
      again.restore(1.);
      if (folder.is_first())
        {
          EXPECT_EQ(again.entries(), expected) << name;
        }
    }
}

TEST(PvdSeries, MpiSameTimeIsReplaced)
{
  const TemporaryFolder folder;
  PvdSeries             series(folder / "a.pvd", world);
  series.add(1., "old");
  series.add(1., "new");
  if (folder.is_first())
    {
      EXPECT_EQ(series.entries(), (Entries{{1., "new"}}));
    }
}

TEST(PvdSeries, MpiUnwritablePathThrowsOnAllRanks)
{
  const TemporaryFolder folder;
  PvdSeries             series(folder / "missing/a.pvd", world);
  const std::string     message = message_of<OutputError>([&] { series.add(0., "x"); });
  EXPECT_NE(message.find("missing/a.pvd"), std::string::npos) << message;
  EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
}

TEST(PvdSeries, MpiNextNumberReplacesNoFile)
{
  const TemporaryFolder folder;
  PvdSeries             series(folder / "points.pvd", world);
  EXPECT_EQ(series.next_number(), 0u);
  series.add(0.5, "points_0007.pvtu");
  series.add(1., "points_0003.pvtu");
  EXPECT_EQ(series.next_number(), 8u);
}
