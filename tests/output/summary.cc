#include "temporary_folder.h"

#include <stroma/base/output_error.h>
#include <stroma/output/summary.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

using namespace Stroma;
using namespace Stroma::Output;

namespace
{
  Summary
  example()
  {
    Summary s;
    s.status            = "finished";
    s.title             = "cell \"A\"";
    s.method            = "mpm";
    s.dimension         = 3;
    s.n_ranks           = 2;
    s.n_points          = 13600000;
    s.newton_iterations = 17;
    s.wall_time_s       = 12.5;
    s.phases            = {{"setup", 2.5}, {"assembly", 4.}};
    s.peak_memory_bytes = 7300000000ull;
    s.used              = {"quasi-static"};
    s.left_out          = {"velocity", "mass matrix"};
    s.results           = {{"work_J", 1e-12}, {"slope", std::nan("")}};
    return s;
  }
} // namespace

TEST(Summary, MpiJsonHoldsWhatWasGivenAndNullForNoNumber)
{
  const TemporaryFolder folder;
  example().write(folder / "summary.json", MPI_COMM_WORLD);
  const auto json = nlohmann::json::parse(read_text(folder / "summary.json"));
  EXPECT_EQ(json["status"], "finished");
  EXPECT_EQ(json["title"], "cell \"A\"");
  EXPECT_EQ(json["n_points"], 13600000);
  EXPECT_EQ(json["newton_iterations"], 17);
  EXPECT_EQ(json["phases"]["assembly"], 4.);
  EXPECT_EQ(json["peak_memory_bytes"], 7300000000ull);
  EXPECT_TRUE(json["bytes_per_point"].is_null());
  EXPECT_EQ(json["left_out"][1], "mass matrix");
  EXPECT_EQ(json["results"]["work_J"], 1e-12);
  EXPECT_TRUE(json["results"]["slope"].is_null());
  EXPECT_EQ(json["without_value"], nlohmann::json({"slope"}));
  EXPECT_EQ(Summary::status_in(folder / "summary.json"), "finished");
  EXPECT_EQ(Summary::status_in(folder / "nothing.json"), "");
  EXPECT_EQ(json["version"], STROMA_VERSION);
  EXPECT_EQ(json["date"].get<std::string>().size(), 24u); // 2024-01-31T12:00:00+0100
  EXPECT_FALSE(std::filesystem::exists(folder / "summary.json.tmp"));
}

TEST(Summary, MpiUnwritableThrowsOnAllRanks)
{
  const TemporaryFolder folder;
  EXPECT_THROW(example().write(folder / "missing/summary.json", MPI_COMM_WORLD), OutputError);
}

TEST(Summary, TableShowsTheNumbers)
{
  std::ostringstream out;
  example().print(out);
  const std::string text = out.str();
  for (const std::string word :
       {"finished", "mpm in 3D on 2 ranks", "13600000", "12.5 s", "7300 MB", "work_J", "1e-12"})
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  EXPECT_EQ(text.find("mass matrix"), std::string::npos); // what is left out stands in the file only
  EXPECT_EQ(text.find("unknowns"), std::string::npos);    // a count of zero
}
