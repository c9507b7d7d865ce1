#include "message_of.h"

#include <stroma/base/parameter_file.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

namespace
{
  using namespace Stroma;

  std::string
  message_of_text(const std::string &text)
  {
    return message_of([&] { ParameterFile::parse(text, "f.prm"); });
  }

  /// A folder for files that include each other.
  class Files
  {
  public:
    Files()
      : path(std::filesystem::temp_directory_path() / ("stroma_files_" + std::to_string(::getpid())))
    {
      std::filesystem::remove_all(path);
      std::filesystem::create_directories(path);
    }
    ~Files()
    {
      std::filesystem::remove_all(path);
    }

    std::string
    put(const std::string &name, const std::string &text) const
    {
      std::ofstream(path / name, std::ios::binary) << text;
      return (path / name).string();
    }

    const std::filesystem::path path;
  };

  TEST(ParameterFile, KnowsWhereEachEntryWasGiven)
  {
    const auto file = ParameterFile::parse("set A = 1 # comment\nsubsection S\n  set B = 2, \\\n 3\nend\nset C = x=y\n",
                                           "f.prm");
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
    file.set("S/T/new entry=\"9 # nine\"");
    EXPECT_EQ(file.find({"S"}, "B")->value, "7");
    EXPECT_EQ(file.find({"S", "T"}, "new entry")->value, "9 # nine");
    EXPECT_EQ(file.subsections({"S"}), std::vector<std::string>{"T"});
    EXPECT_EQ(file.without("S").find({"S"}, "B"), nullptr);
    EXPECT_EQ(message_of([&] { file.set("no assignment"); }), "--set no assignment: expected Section/name=value");
  }

  TEST(ParameterFile, SyntaxErrorsNameTheLine)
  {
    EXPECT_EQ(message_of_text("set A = 1\nend\n"), "f.prm:2: 'end' without a 'subsection' before it; remove it");
    EXPECT_EQ(message_of_text("set A = 1\nsubsection S\n"), "f.prm:2: 'subsection S' is never closed; add an 'end'");
    EXPECT_EQ(message_of_text("st A = 1\n").find("f.prm:1: 'st A = 1' is not understood"), 0u);
    EXPECT_EQ(message_of_text("set = 7\n").find("f.prm:1: 'set = 7' names no entry"), 0u);
    EXPECT_EQ(message_of_text("set FEM/Cells = 7\n").find("f.prm:1: the name of the entry 'FEM/Cells' holds '/'"), 0u);
  }

  TEST(ParameterFile, NothingStandsTwiceInOneFile)
  {
    EXPECT_EQ(message_of_text("set A = sqrt(-1)\n\nset A = 1\n"),
              "f.prm:3: 'A' is given twice: it was given already at f.prm:1; remove one of the two");
    EXPECT_EQ(
      message_of_text("subsection L\nsubsection pull\nend\nsubsection pull\nend\nend\n"),
      "f.prm:4: section 'L/pull' stands twice: it was opened already at f.prm:2; put its entries into one, or rename one");
    EXPECT_EQ(message_of_text("subsection A\nsubsection s\nend\nend\nsubsection B\nsubsection s\nend\nend\n"), "");
  }

  TEST(ParameterFile, OverridesWhatItIncludedBefore)
  {
    const Files files;
    files.put("scene.prm", "set A = 1\nsubsection S\n set B = 1\nend\n");
    files.put("more.prm", "set A = 2\n");
    const auto over = ParameterFile::read(
      files.put("over.prm",
                "include scene.prm\ninclude more.prm\nset C = 4\nsubsection S\n set B = 3\n set D = 1\nend\n"));
    EXPECT_EQ(over.find({}, "A")->value, "2");
    EXPECT_EQ(over.find({"S"}, "B")->value, "3");
    const auto under = files.put("under.prm", "set A = 3\ninclude scene.prm\n");
    const auto said  = message_of([&] { ParameterFile::read(under); });
    EXPECT_NE(said.find("scene.prm:1: 'A' is given twice"), std::string::npos) << said;
    EXPECT_NE(said.find("under.prm:1; a file overrides only what it has included before"), std::string::npos) << said;
  }

  TEST(ParameterFile, EncodingsAndInvisibleCharacters)
  {
    EXPECT_EQ(ParameterFile::parse("\xEF\xBB\xBFset A = 1\r\nset B = 2\r\n", "f.prm").find({}, "B")->value, "2");
    EXPECT_EQ(ParameterFile::parse("\xEF\xBB\xBF# comment\nset\tA = 1\n", "f.prm").find({}, "A")->value, "1");
    EXPECT_EQ(
      message_of_text("# old\rset A = 1\rset B = 2\r").find("f.prm:1: a carriage return (U+000D) ends this line"), 0u);
    EXPECT_EQ(message_of_text("set A = 1000\u00A0\n"),
              "f.prm:1: 'set A = 1000\u00A0' holds U+00A0 (no-break space), which cannot be seen; remove it");
    EXPECT_NE(message_of_text("set A = 1\u200B\n").find("U+200B (zero-width space)"), std::string::npos);
    EXPECT_NE(message_of_text("set Poisson\u2019s ratio = .3\n").find("U+2019 (curly quote)"), std::string::npos);
    EXPECT_NE(message_of_text("set A = \x1B[2J\n").find("'set A = \\x1B[2J' holds U+001B"), std::string::npos);
    EXPECT_EQ(message_of_text("set A = Gef\u00E4\u00DF # \u00A0 in a comment\n"), "");
    EXPECT_NE(message_of_text(std::string("\xFF\xFEs\0", 4)).find("UTF-16"), std::string::npos);
    EXPECT_LT(message_of_text("set A = " + std::string(100000, 'x') + "\nset A = 1").size(), 200u);
  }

  TEST(ParameterFile, QuotedValuesMayHoldAHash)
  {
    const auto value = [](const std::string &line) { return ParameterFile::parse(line, "f.prm").find({}, "A")->value; };
    EXPECT_EQ(value("set A = \"stack#3.nrrd\" # a comment"), "stack#3.nrrd");
    EXPECT_EQ(value("set A = \"a \"\"b\"\" #c\""), "a \"b\" #c");
    EXPECT_EQ(value("set A = a \"b\" # c"), "a \"b\"");
    EXPECT_EQ(value("set A = \"\""), "");
    EXPECT_NE(message_of_text("set A = \"a\", \"b\""), "");
    EXPECT_NE(message_of_text("set A = \"a"), "");
    for (const std::string text : {"stack#3.nrrd", "\"", "\"#\"", "a\\", "a \"b\" c", "", " blank at the ends "})
      EXPECT_EQ(value("set A = " + ParameterFile::written(text)), text);
  }

  TEST(ParameterFile, OnlyPlainFilesOfSensibleSize)
  {
    const Files files;
    const auto  message = [&](const std::string &text) {
      return message_of([&] { ParameterFile::read(files.put("f.prm", text)); });
    };
    for (const std::string device : {"/dev/zero", "/dev/urandom", "/dev/stdin", ".", "pipe"})
      {
        ::mkfifo((files.path / "pipe").c_str(), 0600);
        EXPECT_NE(message("include " + device + "\n").find("f.prm:1: the parameter file '"), std::string::npos);
        EXPECT_NE(message("include " + device + "\n").find("is no plain file"), std::string::npos) << device;
      }
    EXPECT_NE(message_of([] { ParameterFile::read("/nowhere/f.prm"); }).find("cannot be read"), std::string::npos);
    EXPECT_NE(message_of([] { ParameterFile::read(std::string(300, 'a')); }).find("cannot be read"), std::string::npos);

    files.put("secret", "root:x:0:0\n");
    EXPECT_EQ(message("include secret\n").find("root"), std::string::npos);
    EXPECT_NE(message("include secret\n").find("secret:1: this line is not understood"), std::string::npos);

    EXPECT_NE(message("include f.prm\n").find("circle"), std::string::npos);
    for (unsigned int level = 0; level < 9; ++level)
      {
        std::string text;
        for (unsigned int i = 0; i < 10; ++i)
          text += "include level" + std::to_string(level + 1) + "\n";
        files.put("level" + std::to_string(level), text);
      }
    files.put("level9", "");
    EXPECT_NE(message("include level0\n").find("are more than 1,000"), std::string::npos);

    std::string deep;
    for (unsigned int i = 0; i < 20000; ++i)
      deep += "subsection a\n";
    EXPECT_NE(message(deep).find("f.prm:21: sections are more than 20 deep"), std::string::npos);
    std::string many;
    for (unsigned int i = 0; i < 200000; ++i)
      many += "set a" + std::to_string(i) + " = 1\n";
    EXPECT_NE(message(many).find("more than 100,000 entries"), std::string::npos);
  }
} // namespace
