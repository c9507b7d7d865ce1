#pragma once

#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace Stroma::Image
{
  constexpr const char *axis_names[] = {"x", "y", "z"};

  /// A number for messages, with up to six digits.
  inline std::string
  number(const double value)
  {
    std::ostringstream text;
    text << value;
    return text.str();
  }

  /// Parts of `text` between white space.
  std::vector<std::string> words(const std::string &text);

  /// What a file says, for messages: other than plain letters become '?', cut after 80.
  std::string readable(std::string text);

  /// `text` in small letters.
  std::string lower_case(std::string text);

  /// The number that all of `text` is, if it is one.
  std::optional<double> to_number(const std::string &text);

  /// Length in metres of a unit as headers name it ("um", "microns", "mm", ...), if it is known.
  std::optional<double> metres(const std::string &unit);

  /// A length [m] as files name it as a unit: "um", "mm", "nm", or as a number of m.
  std::string unit_word(double unit);
} // namespace Stroma::Image
