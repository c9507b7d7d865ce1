#include "message_of.h"

#include <stroma/base/counted.h>
#include <stroma/base/parameters.h>
#include <stroma/base/unknown_entries.h>

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

namespace
{
  using namespace Stroma;

  TEST(Parameters, ConvertsUnitsAndEvaluatesExpressions)
  {
    const auto          file = ParameterFile::parse("subsection Units\n set Length = um\n set Force = nN\nend\n"
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
    Parameters p(file);
    double     size = 1, other = std::nan("");
    unsigned int count = 1;
    int          word  = 0;
    EXPECT_EQ(message_of([&] { p.add("Size", size, "a length", "m", Range::positive()); }),
              "f.prm:1: 'Size' was given as '-1'; it must be a number in (0, inf) [m]");
    EXPECT_EQ(message_of([&] {
                p.add_choice<int>("Word", word, "a word", {{"mpm", 1}, {"fem", 2}});
              }),
              "f.prm:2: 'Word' was given as 'mx'; it must be one of: mpm, fem");
    EXPECT_EQ(message_of([&] { p.add("Count", count, "a number"); }),
              "f.prm:3: 'Count' was given as '1.5'; it must be a whole number in [0, 2147483647]");
    EXPECT_NE(message_of([&] {
                p.add("Text", size, "a length", "m", Range::any());
              }).find("f.prm:4: 'Text' was given as 'abc'"),
              std::string::npos);
    EXPECT_NE(message_of([&] {
                p.add("Missing", other, "something", "Pa", Range::any());
              }).find("'Missing' is missing"),
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
      EXPECT_EQ(message_of([&] { p.finish(); }).find("f.prm:1: section 'S' is not used by this scene"), 0u);
    }
  }

  // Of several the one that is most like a known name: 'Radius' is unknown because 'Shap' is.
  TEST(Parameters, TheNearestOfUnknownEntriesIsTold)
  {
    const auto  file = ParameterFile::parse("subsection S\n set Radius = 1\n set Shap = ball\nend\n", "f.prm");
    Parameters  p(file);
    std::string shape;
    {
      const auto s = p.section("S");
      p.add("Shape", shape, "");
    }
    EXPECT_EQ(message_of([&] { p.finish(); }),
              "f.prm:3: 'Shap' is not a parameter of section 'S' of this scene; known here: Shape");
  }

  // An error that ends the reading: only what can be known to be unknown is told.
  TEST(Parameters, WhatIsUnknownComesBeforeWhatIsMissing)
  {
    const std::string text = "subsection First\n set Sise = 1\nend\nsubsection Second\n set Other = 1\nend\n";
    const auto        file = ParameterFile::parse(text, "f.prm");
    const auto        read = [&](Parameters &p) {
      double size = std::nan("");
      {
        const auto first = p.section("First");
        p.add("Size", size, "", "", Range::any());
      }
      const auto second = p.section("Second");
      throw UserError("of the second section");
    };
    Parameters reading(file), documenting(file, Parameters::Mode::document);
    EXPECT_EQ(message_of([&] { read(reading); }), "f.prm:1: 'Size' is missing (); give a number in (-inf, inf)");
    EXPECT_EQ(message_of([&] {
                unknown_first([&] { read(reading); },
                              [&] {
                                unknown_first([&] { read(documenting); }, [&] { documenting.finish_declared(); });
                              });
              }),
              "f.prm:2: 'Sise' is not a parameter of section 'First' of this scene; known here: Size");
    EXPECT_EQ(message_of([&] { documenting.finish_declared({"First", "Seconds"}); }).find("f.prm:2: 'Sise'"), 0u);
    const auto good = ParameterFile::parse(
      "subsection First\n set Size = 1\nend\nsubsection Second\n set Other = 1\nend\n", "f.prm");
    Parameters again(good, Parameters::Mode::document);
    EXPECT_EQ(message_of([&] { unknown_first([&] { read(again); }, [&] { again.finish_declared(); }); }),
              "of the second section");
    EXPECT_EQ(message_of([&] {
                again.finish_declared({"First", "Seconds"});
              }),
              "f.prm:4: section 'Second' is not used by this scene; known here: Seconds, First");
  }

  TEST(Parameters, WholeNumbersKeepTheirRange)
  {
    for (const std::string text :
         {"4294967297", "4294967295", "2147483648", "-1", "1e10", "0.5", "1e400", "1,5", "nan", "inf"})
      {
        const auto   file = ParameterFile::parse("set Count = " + text + "\n", "f.prm");
        Parameters   p(file);
        unsigned int count = 1;
        EXPECT_EQ(message_of([&] {
                    p.add("Count", count, "a number");
                  }).find("f.prm:1: 'Count' was given as '" + text.substr(0, 1)),
                  0u)
          << text;
        EXPECT_EQ(count, 1u) << text;
      }
  }

  TEST(Parameters, DecimalCommasAreRefusedByName)
  {
    const auto file = ParameterFile::parse(
      "subsection Constants\n set a = 2\nend\nset Size = 0,5\nset List = min(a,1), 2\n", "f.prm");
    Parameters          p(file);
    double              size = 1;
    std::vector<double> list;
    EXPECT_EQ(
      message_of([&] { p.add("Size", size, "a length", "m", Range::positive()); }),
      "f.prm:4: 'Size' was given as '0,5': the comma after '0' stands outside a function's parentheses; decimals are "
      "written with a point, as in 0.5; it must be a number in (0, inf) [m], or an expression of the names in section "
      "Constants");
    p.add("List", list, "two lengths", "m", Range::positive(), 2);
    EXPECT_EQ(list, (std::vector<double>{1., 2.}));
  }

  TEST(Parameters, ConstantsAreCheckedByNameAndValue)
  {
    for (const std::string line : {"x = 1", "a b = 1", "a,b = 1", "set = 0,5", "a = sqrt(-1)", "a = 1/0", "a = rand()"})
      {
        const auto file = ParameterFile::parse("subsection Constants\n set " + line + "\nend\n", "f.prm");
        EXPECT_EQ(message_of([&] { Parameters p(file); }).find("f.prm:2: "), 0u) << line;
      }
    const auto file = ParameterFile::parse("subsection Constants\n set tiny = 1e-310\nend\n", "f.prm");
    EXPECT_EQ(Parameters(file).constants().at("tiny"), 1e-310);
  }

  TEST(Parameters, MessagesAndDocumentationHaveTheFilesUnits)
  {
    const auto file = ParameterFile::parse(
      "subsection Units\n set Length = um\n set Stress = kPa\n set Force = nN\nend\n"
      "set Stiffness = -1\nset Size = 10\nset Density = 1\n",
      "f.prm");
    Parameters p(file);
    double     stiffness = 2000, size = 1e-5, density = 1e9;
    EXPECT_EQ(message_of([&] { p.add("Stiffness", stiffness, "stiffness", "Pa", Range::positive()); }),
              "f.prm:6: 'Stiffness' was given as '-1'; it must be a number in (0, inf) [kPa]");
    p.add("Size", size, "a length", "m", Range::positive());
    p.add("Density", density, "a force density", "N/m^3", Range::any());
    EXPECT_NE(p.print(true).find("# a length [um]; (0, inf)\nset Size    = 10\n"), std::string::npos) << p.print(true);
    EXPECT_NE(p.print(true).find("# a force density [nN/um^3]; (-inf, inf)\nset Density = 1\n"), std::string::npos);
    EXPECT_EQ(p.in_file_units(64e-6, "m"), "64 um");
  }

  TEST(Parameters, NamesOfThingsComeFromAnAlphabet)
  {
    const auto file = ParameterFile::parse("subsection Supports\n subsection top\n end\n subsection a,b\n end\nend\n",
                                           "f.prm");
    Parameters p(file);
    const auto section = p.section("Supports");
    EXPECT_EQ(message_of([&] { p.names("support"); }).find("f.prm:4: the name of support 'a,b' holds ','"), 0u);
  }

  /// One entry of every kind.
  struct OfAllKinds
  {
    double                    number = .1, tiny = 1e-310;
    unsigned int              whole = 3;
    bool                      flag  = false;
    std::string               text = "default", empty = "default", path;
    std::vector<double>       numbers{1., 2.};
    std::vector<unsigned int> wholes{4, 5};
    std::vector<std::string>  words{"a", "b"};
    int                       choice = 1;

    explicit OfAllKinds(Parameters &p)
    {
      const auto s = p.section("S", "a section");
      p.add("Number", number, "a length", "m", Range::positive());
      p.add("Tiny", tiny, "tiny", "", Range::any());
      p.add("Whole", whole, "a whole number");
      p.add("Flag", flag, "yes or no");
      p.add("Text", text, "a text");
      p.add("Empty", empty, "a text");
      p.add("Path", path, "a text");
      p.add("Numbers", numbers, "lengths", "m", Range::any());
      p.add("Wholes", wholes, "whole numbers", Range::any());
      p.add("Words", words, "words");
      p.add_choice<int>("Choice", choice, "a word", {{"one", 1}, {"two words", 2}});
    }

    auto
    all() const
    {
      return std::tie(number, tiny, whole, flag, text, empty, path, numbers, wholes, words, choice);
    }
  };

  TEST(Parameters, PrintedFileReadsBackTheSame)
  {
    const std::string units = "subsection Units\n set Length = um\nend\nsubsection Constants\n set a = 1/7\nend\n";
    for (const std::string &text :
         {std::string(), units,
          units +
            "subsection S\n set Number = a/3\n set Tiny = 3e-320\n set Whole = 7\n set Flag = true\n"
            " set Text = \"a \"\"b\"\" # c\"\n set Empty =\n set Path = \"stack#3.nrrd\"\n set Numbers = a, -1e-7, 3\n"
            " set Wholes =\n set Words =\n set Choice = two words\nend\n"})
      for (const bool documented : {true, false})
        {
          const auto       file = ParameterFile::parse(text, "f.prm");
          Parameters       p(file);
          const OfAllKinds first(p);
          p.finish();
          const auto       printed = ParameterFile::parse(p.print(documented), "printed.prm");
          Parameters       again(printed);
          const OfAllKinds second(again);
          again.finish();
          EXPECT_EQ(first.all(), second.all()) << p.print(documented);
          EXPECT_EQ(p.values(), again.values());
          EXPECT_EQ(p.print(documented), again.print(documented));
        }
  }

  TEST(Parameters, TemplateOfAFileSaysWhatTheFileSays)
  {
    const auto document = [](const std::string &text) {
      const auto file = ParameterFile::parse(text, "f.prm");
      Parameters p(file, Parameters::Mode::document);
      double     other = 3.;
      p.add("Other", other, "a number", "", Range::any());
      for (const std::string name : {"given", "example"})
        {
          double     size = 2.;
          const auto s    = p.section(name);
          p.add("Size", size, "a length", "m", Range::any());
        }
      return p.print(false);
    };
    const auto printed = document("subsection given\n set Size = 5\nend\n");
    const auto file    = ParameterFile::parse(printed, "printed.prm");
    EXPECT_EQ(file.entries().size(), 1u) << printed;
    EXPECT_EQ(file.find({"given"}, "Size")->value, "5");
    EXPECT_EQ(file.subsections({}), std::vector<std::string>{"given"});
    EXPECT_NE(printed.find("# set Other = 3"), std::string::npos) << printed;
    EXPECT_EQ(document("").find("set Other = 3"), 0u) << document("");
  }

  TEST(Counted, OneThingAndSeveral)
  {
    EXPECT_EQ(counted(0, "voxel"), "0 voxels");
    EXPECT_EQ(counted(1, "voxel"), "1 voxel");
    EXPECT_EQ(counted(1234567, "voxel"), "1,234,567 voxels");
  }
} // namespace
