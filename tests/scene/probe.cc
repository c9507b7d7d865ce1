#include "../base/message_of.h"

#include <stroma/scene/probe.h>

#include <gtest/gtest.h>

using namespace Stroma;

namespace
{
  std::vector<Probe<3>>
  probes(const std::string &where)
  {
    const auto file = ParameterFile::parse("subsection Units\n set Length = mm\nend\nsubsection Probes\n"
                                           " subsection tip\n  set Where = " +
                                             where + "\n end\nend\n",
                                           "test.prm");
    Parameters p(file);
    return add_probes<3>(p, {{"gel"}, {"block"}});
  }
} // namespace

TEST(Probe, IsANamedPlaceInMetres)
{
  const auto tip = probes("nearest 1, 2, 3").at(0);
  EXPECT_EQ(tip.name, "tip");
  EXPECT_EQ(tip.where, "test.prm:6");
  EXPECT_NEAR(tip.place.distance({1e-3, 2e-3, 3e-3}), 0., 1e-15);
}

TEST(Probe, ADocumentShowsOne)
{
  const auto file = ParameterFile::parse("", "template");
  Parameters p(file, Parameters::Mode::document);
  add_probes<3>(p, {{"gel"}, {"block"}});
  EXPECT_EQ(p.values().count("Probes/tip/Where"), 1u);
}

TEST(Probe, IsOnePlace)
{
  EXPECT_NE(message_of([] { probes("all"); }).find("a probe is one place, but 'Where' is 'all'"), std::string::npos);
}
