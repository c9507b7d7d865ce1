#pragma once

#include <stroma/base/counted.h>

#include <string>
#include <vector>

namespace Stroma
{
  /// @p text without white space at its ends.
  std::string trim(const std::string &text);

  /// The trimmed parts of @p text between @p separator; an empty text has no parts, a separator at the end an empty one.
  std::vector<std::string> split(const std::string &text, char separator);

  /// The same, but separators inside parentheses do not count: "min(a,b), c" has two parts.
  std::vector<std::string> split_outside_parentheses(const std::string &text, char separator);

  std::string join(const std::vector<std::string> &words, const std::string &separator);

  /// Shortest decimal text that reads back as the same number.
  std::string shortest(double value);

  /// @p text as it stands in a message: control characters escaped, cut after about 100 letters.
  std::string shown(const std::string &text);

  /// Six significant digits, for messages.
  std::string brief(double value);

  /// 93.4 -> "1 min 33 s", for people.
  std::string duration(double seconds);
} // namespace Stroma
