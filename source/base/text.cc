#include <stroma/base/characters.h>
#include <stroma/base/text.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace Stroma
{
  std::string
  trim(const std::string &text)
  {
    const auto first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos)
      return "";
    return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
  }

  namespace
  {
    std::vector<std::string>
    parts_of(const std::string &text, const char separator, const bool respect_parentheses)
    {
      std::vector<std::string> parts;
      std::size_t              begin = 0;
      int                      depth = 0;
      if (trim(text).empty())
        return parts;
      for (std::size_t i = 0; i <= text.size(); ++i)
        {
          if (i < text.size() && respect_parentheses)
            depth += (text[i] == '(') - (text[i] == ')');
          if (i == text.size() || (text[i] == separator && depth <= 0))
            {
              parts.push_back(trim(text.substr(begin, i - begin)));
              begin = i + 1;
            }
        }
      return parts;
    }
  } // namespace

  std::vector<std::string>
  split(const std::string &text, const char separator)
  {
    return parts_of(text, separator, false);
  }

  std::vector<std::string>
  split_outside_parentheses(const std::string &text, const char separator)
  {
    return parts_of(text, separator, true);
  }

  std::string
  join(const std::vector<std::string> &words, const std::string &separator)
  {
    std::string text;
    for (const auto &word : words)
      text += (text.empty() ? "" : separator) + word;
    return text;
  }

  std::string
  shortest(const double value)
  {
    std::string text;
    for (int digits = 6; digits <= 17; ++digits)
      {
        std::ostringstream out;
        out.precision(digits);
        out << value;
        text = out.str();
        if (!std::isfinite(value) || std::strtod(text.c_str(), nullptr) == value)
          break;
      }
    return text;
  }

  std::string
  shown(const std::string &text)
  {
    constexpr std::size_t longest = 120, kept = 100;
    std::size_t           end = text.size();
    if (end > longest)
      for (end = kept; end > 0 && (text[end] & 0xC0) == 0x80;) // do not cut a UTF-8 character in two
        --end;
    const std::string result = printable(text.substr(0, end));
    return end == text.size() ? result : result + "... (" + grouped(text.size()) + " bytes)";
  }

  std::string
  brief(const double value)
  {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", value);
    return text;
  }

  std::string
  duration(const double seconds)
  {
    char text[64];
    if (seconds < 59.5)
      std::snprintf(text, sizeof(text), "%.1f s", seconds);
    else if (seconds < 3570)
      std::snprintf(text, sizeof(text), "%d min %d s", static_cast<int>(seconds + .5) / 60,
                    static_cast<int>(seconds + .5) % 60);
    else
      std::snprintf(text, sizeof(text), "%d h %d min", static_cast<int>(seconds / 60 + .5) / 60,
                    static_cast<int>(seconds / 60 + .5) % 60);
    return text;
  }
} // namespace Stroma
