#pragma once

#include <string>

namespace Stroma
{
  /**
   * Characters that look like others or like nothing, so that a person cannot find them: no-break and other odd spaces,
   * zero-width marks, control characters, and what is not UTF-8.
   * @return the first one in @p text, for example "U+00A0 (no-break space)", or "" if there is none
   */
  std::string invisible_character(const std::string &text);

  /**
   * The first character outside ASCII, or invisible, by code and, where it is a usual slip, by name:
   * "U+2019 (curly quote)", "U+2212 (minus sign)". Names of entries, numbers and expressions hold none. "" if there is none.
   */
  std::string odd_character(const std::string &text);

  /// @p text with its control characters escaped, so that a message is one line and does nothing to the terminal.
  std::string printable(const std::string &text);

  /// @p text, a message, with words (names, paths) of more than 500 letters cut as by shown().
  std::string with_short_words(const std::string &text);

  /**
   * What a user calls a thing (material, body, support, study case, ...) becomes a folder, a column and a key: letters,
   * digits, blanks and _ - + . ( ) %, beginning and ending with none of the blanks and dots.
   * Throws UserError naming @p where and @p kind ("support") for other names.
   */
  void check_name(const std::string &where, const std::string &kind, const std::string &name);
} // namespace Stroma
