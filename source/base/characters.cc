#include <stroma/base/characters.h>
#include <stroma/base/errors.h>
#include <stroma/base/text.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace Stroma
{
  namespace
  {
    struct Named
    {
      std::uint32_t first, last;
      const char   *name;
    };

    const std::vector<Named> invisible = {
      {0x0000, 0x0008, "control character"},   {0x000B, 0x001F, "control character"},
      {0x007F, 0x009F, "control character"},   {0x00A0, 0x00A0, "no-break space"},
      {0x00AD, 0x00AD, "soft hyphen"},         {0x034F, 0x034F, "invisible joiner"},
      {0x061C, 0x061C, "direction mark"},      {0x1680, 0x1680, "odd space"},
      {0x180E, 0x180E, "invisible separator"}, {0x2000, 0x200A, "odd space"},
      {0x200B, 0x200B, "zero-width space"},    {0x200C, 0x200D, "zero-width joiner"},
      {0x200E, 0x200F, "direction mark"},      {0x2028, 0x2029, "line separator"},
      {0x202A, 0x202E, "direction mark"},      {0x202F, 0x202F, "narrow no-break space"},
      {0x205F, 0x205F, "odd space"},           {0x2060, 0x206F, "invisible mark"},
      {0x3000, 0x3000, "ideographic space"},   {0xFE00, 0xFE0F, "invisible mark"},
      {0xFEFF, 0xFEFF, "byte-order mark"},     {0xFFFD, 0xFFFD, "replacement character"},
      {0xE0000, 0xE0FFF, "invisible mark"}};

    /// Visible ones that word processors and keyboards put in the place of ASCII.
    const std::vector<Named> slips = {
      {0x00B4, 0x00B4, "acute accent"},  {0x00B7, 0x00B7, "middle dot"},       {0x00D7, 0x00D7, "multiplication sign"},
      {0x00F7, 0x00F7, "division sign"}, {0x00B2, 0x00B3, "superscript"},      {0x2010, 0x2015, "dash"},
      {0x2018, 0x201B, "curly quote"},   {0x201C, 0x201F, "curly quotes"},     {0x2032, 0x2033, "prime"},
      {0x2212, 0x2212, "minus sign"},    {0xFF01, 0xFF5E, "full-width letter"}};

    constexpr std::uint32_t not_utf8 = 0xFFFFFFFF;

    /// The character that begins at @p place, and moves @p place behind it.
    std::uint32_t
    next(const std::string &text, std::size_t &place)
    {
      const auto first = static_cast<unsigned char>(text[place++]);
      if (first < 0x80)
        return first;
      const unsigned int more = first >= 0xF0 && first < 0xF8 ? 3 : first >= 0xE0 ? 2 : 1;
      if (first < 0xC2 || first >= 0xF5 || place + more > text.size())
        return not_utf8;
      std::uint32_t code = first & (0x3F >> more);
      for (unsigned int i = 0; i < more; ++i)
        {
          const auto byte = static_cast<unsigned char>(text[place]);
          if ((byte & 0xC0) != 0x80)
            return not_utf8;
          code = code << 6 | (byte & 0x3F);
          ++place;
        }
      return code;
    }

    const char *
    name_in(const std::vector<Named> &table, const std::uint32_t code)
    {
      for (const auto &entry : table)
        if (code >= entry.first && code <= entry.last)
          return entry.name;
      return nullptr;
    }

    std::string
    described(const std::uint32_t code, const char *name)
    {
      char text[16];
      std::snprintf(text, sizeof(text), "U+%04X", static_cast<unsigned int>(code));
      return std::string(text) + (name ? std::string(" (") + name + ")" : "");
    }

    std::string
    byte_that_is_not_utf8(const std::string &text, const std::size_t place)
    {
      char described[64];
      std::snprintf(described, sizeof(described), "byte 0x%02X (not UTF-8; save the file as UTF-8)",
                    static_cast<unsigned int>(static_cast<unsigned char>(text[place])));
      return described;
    }

    bool
    is_letter(const std::uint32_t code)
    {
      return (code >= 'a' && code <= 'z') || (code >= 'A' && code <= 'Z') || (code >= '0' && code <= '9') ||
             (code >= 0xC0 && !name_in(invisible, code) && !name_in(slips, code));
    }
  } // namespace

  std::string
  invisible_character(const std::string &text)
  {
    for (std::size_t place = 0; place < text.size();)
      {
        const std::size_t at   = place;
        const auto        code = next(text, place);
        if (code == not_utf8)
          return byte_that_is_not_utf8(text, at);
        if (const char *name = name_in(invisible, code))
          return described(code, name);
      }
    return "";
  }

  std::string
  odd_character(const std::string &text)
  {
    for (std::size_t place = 0; place < text.size();)
      {
        const std::size_t at   = place;
        const auto        code = next(text, place);
        if (code == not_utf8)
          return byte_that_is_not_utf8(text, at);
        if (const char *name = name_in(invisible, code))
          return described(code, name);
        if (code >= 0x80)
          return described(code, name_in(slips, code));
      }
    return "";
  }

  std::string
  printable(const std::string &text)
  {
    std::string result;
    for (const char c : text)
      if (const auto byte = static_cast<unsigned char>(c); byte < 0x20 || byte == 0x7F)
        {
          char escaped[8];
          std::snprintf(escaped, sizeof(escaped), "\\x%02X", static_cast<unsigned int>(byte));
          result += escaped;
        }
      else
        result += c;
    return result;
  }

  std::string
  with_short_words(const std::string &text)
  {
    constexpr std::size_t longest = 500;
    std::string           result;
    for (std::size_t start = 0; start < text.size();)
      {
        const std::size_t end  = std::min(text.find(' ', start), text.size());
        const std::string word = text.substr(start, end - start);
        result += word.size() > longest ? shown(word) : word;
        if (end < text.size())
          result += ' ';
        start = end + 1;
      }
    return result;
  }

  void
  check_name(const std::string &where, const std::string &kind, const std::string &name)
  {
    constexpr std::size_t longest = 80;
    std::string           wrong;
    for (std::size_t place = 0; place < name.size() && wrong.empty();)
      {
        const std::size_t at   = place;
        const auto        code = next(name, place);
        if (code == not_utf8)
          wrong = byte_that_is_not_utf8(name, at);
        else if (!is_letter(code) &&
                 (code >= 0x80 || std::string(" _-+.()%").find(static_cast<char>(code)) == std::string::npos))
          wrong = code > 0x20 && code < 0x7F ? "'" + name.substr(at, 1) + "'" :
                                               described(code, name_in(invisible, code));
      }
    const auto is_end = [](const char c) { return c == ' ' || c == '.'; };
    if (wrong.empty() && name.size() > longest)
      wrong = "more than " + std::to_string(longest) + " bytes";
    else if (wrong.empty() && !name.empty() && name.find_first_not_of(" .") == std::string::npos)
      wrong = "nothing but dots";
    else if (wrong.empty() && !name.empty() && (is_end(name.front()) || is_end(name.back())))
      wrong = "a blank or dot at an end";
    if (wrong.empty() && name.empty())
      wrong = "nothing";
    if (!wrong.empty())
      throw UserError(where, "the name of " + kind + " '" + shown(name) + "' holds " + wrong +
                               "; names become folders and "
                               "columns and are made of letters, digits, blanks and _ - + . ( ) %");
  }
} // namespace Stroma
