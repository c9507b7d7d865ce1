#include "message_of.h"

#include <stroma/base/characters.h>
#include <stroma/base/text.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;

  TEST(Characters, InvisibleOnesAreNamedByTheirCode)
  {
    EXPECT_EQ(invisible_character("1000\u00A0"), "U+00A0 (no-break space)");
    EXPECT_EQ(invisible_character("a\u200Bb"), "U+200B (zero-width space)");
    EXPECT_EQ(invisible_character("a\x1B[1m"), "U+001B (control character)");
    EXPECT_EQ(invisible_character(std::string("a\0", 2)), "U+0000 (control character)");
    EXPECT_EQ(invisible_character("gef\xE4\xDF"), "byte 0xE4 (not UTF-8; save the file as UTF-8)");
    EXPECT_EQ(invisible_character("a\tGef\u00E4\u00DF \u201Cx\u201D"), "");
    EXPECT_EQ(odd_character("Poisson\u2019s"), "U+2019 (curly quote)");
    EXPECT_EQ(odd_character("\u221E"), "U+221E");
  }

  TEST(Characters, NamesBecomeFoldersAndColumns)
  {
    for (const std::string good : {"top", "y-max", "Q2 projected", "c .5", "Gef\u00E4\u00DF", "50 % (wet)", "a+b_1"})
      EXPECT_EQ(message_of([&] { check_name("f.prm:1", "support", good); }), "") << good;
    for (const std::string bad : {"", ".", "..", "a/b", "a,b", "a\"b", "a;b", "a:b", "a\nb", "a\\b", "a|b", "..a", " a",
                                  "a.", "a\u2019s", "a\u00A0b"})
      EXPECT_NE(message_of([&] { check_name("f.prm:1", "support", bad); }), "") << bad;
    EXPECT_EQ(
      message_of([] { check_name("f.prm:1", "support", "a,b"); }),
      "f.prm:1: the name of support 'a,b' holds ','; names become folders and columns and are made of letters, digits, "
      "blanks and _ - + . ( ) %");
    EXPECT_NE(message_of([] { check_name("", "case", std::string(300, 'a')); }), "");
  }

  TEST(Text, MessagesShowValuesShortAndWithoutControlCharacters)
  {
    EXPECT_EQ(shown("a\x1B[1m"), "a\\x1B[1m");
    EXPECT_EQ(shown(std::string(120, 'a')), std::string(120, 'a'));
    EXPECT_EQ(shown(std::string(100000, 'a')), std::string(100, 'a') + "... (100,000 bytes)");
    const std::string path = "out/" + std::string(3000, '1');
    EXPECT_EQ(with_short_words(path + ": is no folder"),
              "out/" + std::string(96, '1') + "... (3,005 bytes) is no folder");
    EXPECT_EQ(with_short_words("a  b "), "a  b ");
    std::string umlauts;
    for (unsigned int i = 0; i < 100; ++i)
      umlauts += i == 0 ? "a" : "\u00E4";
    EXPECT_EQ(invisible_character(shown(umlauts)), "");
  }

  TEST(Text, SplittingKeepsEmptyPartsAndFunctions)
  {
    EXPECT_EQ(split("a, b", ','), (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(split("a,,", ','), (std::vector<std::string>{"a", "", ""}));
    EXPECT_TRUE(split(" ", ',').empty());
    EXPECT_EQ(split_outside_parentheses("min(a,b), c", ','), (std::vector<std::string>{"min(a,b)", "c"}));
  }

  TEST(Text, ShortestTakesSubnormalNumbers)
  {
    EXPECT_EQ(std::strtod(shortest(3e-310).c_str(), nullptr), 3e-310);
  }
} // namespace
