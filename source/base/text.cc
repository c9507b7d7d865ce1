#include <stroma/base/text.h>

#include <cmath>
#include <cstdio>
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

  std::vector<std::string>
  split(const std::string &text, const char separator)
  {
    std::vector<std::string> parts;
    std::istringstream       in(text);
    for (std::string part; std::getline(in, part, separator);)
      parts.push_back(trim(part));
    return parts;
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
        if (!std::isfinite(value) || std::stod(text) == value)
          break;
      }
    return text;
  }

  std::string
  brief(const double value)
  {
    char text[32];
    std::snprintf(text, sizeof(text), "%.6g", value);
    return text;
  }

  std::string
  grouped(const unsigned long long value)
  {
    std::string text = std::to_string(value);
    for (int place = static_cast<int>(text.size()) - 3; place > 0; place -= 3)
      text.insert(place, ",");
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
