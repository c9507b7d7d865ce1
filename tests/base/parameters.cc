#include <stroma/base/parameters.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  /// The message of the UserError that @p work throws, or "".
  template <typename Work>
  std::string
  message_of(const Work &work)
  {
    try
      {
        work();
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  TEST(ParameterFile, KnowsWhereEachEntryWasGiven)
  {
    const auto file = ParameterFile::parse("set A = 1 # comment\nsubsection S\n  set B = 2, \\\n 3\nend\nset C = x=y\n", "f.prm");
    EXPECT_EQ(file.find({}, "A")->value, "1");
    EXPECT_EQ(file.find({"S"}, "B")->value, "2, 3");
    EXPECT_EQ(file.find({}, "C")->where, "f.prm:6");
    EXPECT_EQ(file.find({}, "C")->value, "x=y");
    EXPECT_EQ(file.find({"S"}, "A"), nullptr);
    EXPECT_EQ(file.where({"S"}), "f.prm:2");
  }

  TEST(ParameterFile, SetOverridesAndAdds)
  {
    auto file = ParameterFile::parse("subsection S\n set B = 2\nend\n", "f.prm");
    file.set("S/B = 7");
    file.set("S/T/new entry=8");
    EXPECT_EQ(file.find({"S"}, "B")->value, "7");
    EXPECT_EQ(file.find({"S", "T"}, "new entry")->value, "8");
    EXPECT_EQ(file.subsections({"S"}), std::vector<std::string>{"T"});
    EXPECT_EQ(message_of([&] { file.set("no assignment"); }), "--set no assignment: expected Section/name=value");
  }

  TEST(ParameterFile, SyntaxErrorsNameTheLine)
  {
    EXPECT_EQ(message_of([] { ParameterFile::parse("set A = 1\nend\n", "f.prm"); }),
              "f.prm:2: 'end' without a 'subsection' before it; remove it");
    EXPECT_EQ(message_of([] { ParameterFile::parse("subsection S\n", "f.prm"); }),
              "f.prm: 'subsection S' is never closed; add an 'end'");
    EXPECT_NE(message_of([] { ParameterFile::parse("st A = 1\n", "f.prm"); }).find("f.prm:1: 'st A = 1' is not understood"),
              std::string::npos);
    EXPECT_NE(message_of([] { ParameterFile::read("/nowhere/f.prm"); }).find("cannot be read"), std::string::npos);
  }

  TEST(Parameters, ConvertsUnitsAndEvaluatesExpressions)
  {
    const auto file = ParameterFile::parse("subsection Units\n set Length = um\n set Force = nN\nend\n"
                                           "subsection Constants\n set a = 2\n set b = a*3\nend\n"
                                           "set Size = a + b/2\nset Density = 4\nset Place = 1, a, b\n",
                                           "f.prm");
    Parameters          p(file);
    double              size = std::nan(""), density = 0;
    std::vector<double> place;
    p.add("Size", size, "a length", "m", Range::positive());
    p.add("Density", density, "a force density", "N/m^3", Range::any());
    p.add("Place", place, "a place", "m", Range::any(), 3);
    EXPECT_DOUBLE_EQ(size, 5e-6);
    EXPECT_NEAR(density / (4e-9 / 1e-18), 1., 1e-14);
    EXPECT_NEAR(place[2] / 6e-6, 1., 1e-14);
    p.finish();
  }

  TEST(Parameters, ValueErrorsNamePlaceAndAllowedValues)
  {
    const auto file = ParameterFile::parse("set Size = -1\nset Word = mx\nset Count = 1.5\nset Text = abc\n", "f.prm");
    Parameters   p(file);
    double       size = 1, other = std::nan("");
    unsigned int count = 1;
    int          word  = 0;
    EXPECT_EQ(message_of([&] { p.add("Size", size, "a length", "m", Range::positive()); }),
              "f.prm:1: 'Size' was given as '-1'; it must be a number in (0, inf) [m]");
    EXPECT_EQ(message_of([&] { p.add_choice<int>("Word", word, "a word", {{"mpm", 1}, {"fem", 2}}); }),
              "f.prm:2: 'Word' was given as 'mx'; it must be one of: mpm, fem");
    EXPECT_EQ(message_of([&] { p.add("Count", count, "a number"); }),
              "f.prm:3: 'Count' was given as '1.5'; it must be a whole number in [0, inf)");
    EXPECT_NE(message_of([&] { p.add("Text", size, "a length", "m", Range::any()); }).find("f.prm:4: 'Text' was given as 'abc'"),
              std::string::npos);
    EXPECT_NE(message_of([&] { p.add("Missing", other, "something", "Pa", Range::any()); }).find("'Missing' is missing"),
              std::string::npos);
  }

  TEST(Parameters, UnknownEntriesAndSectionsAreErrors)
  {
    {
      const auto file = ParameterFile::parse("subsection S\n set Sise = 1\nend\n", "f.prm");
      Parameters p(file);
      double     size = 1;
      {
        const auto s = p.section("S");
        p.add("Other", size, "", "", Range::any());
        p.add("Size", size, "", "", Range::any());
      }
      EXPECT_EQ(message_of([&] { p.finish(); }),
                "f.prm:2: 'Sise' is not a parameter of section 'S' of this scene; known here: Size, Other");
    }
    {
      const auto file = ParameterFile::parse("subsection S\n set A = 1\nend\n", "f.prm");
      Parameters p(file);
      EXPECT_EQ(message_of([&] { p.finish(); }).find("f.prm:2: section 'S' is not used by this scene"), 0u);
    }
  }

  TEST(Parameters, PrintedFileReadsBackTheSame)
  {
    const auto read = [](const ParameterFile &file) {
      Parameters p(file);
      double     size = .1;
      {
        const auto s = p.section("S", "a section");
        p.add("Size", size, "a length", "m", Range::positive());
      }
      p.finish();
      return std::make_pair(p.print(true), size);
    };
    const auto first =
      read(ParameterFile::parse("subsection Units\n set Length = um\nend\nsubsection S\n set Size = 1/3\nend\n", "f.prm"));
    const auto second = read(ParameterFile::parse(first.first, "printed.prm"));
    EXPECT_EQ(first.first, second.first);
    EXPECT_EQ(first.second, second.second);
    EXPECT_NE(first.first.find("# a length [m]; (0, inf)"), std::string::npos);
  }
} // namespace
