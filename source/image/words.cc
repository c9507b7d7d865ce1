#include "words.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>

namespace Stroma::Image
{
  std::vector<std::string>
  words(const std::string &text)
  {
    std::istringstream stream(text);
    return {std::istream_iterator<std::string>(stream), {}};
  }

  std::string
  readable(std::string text)
  {
    std::replace_if(
      text.begin(), text.end(), [](const unsigned char c) { return c < 32 || c > 126; }, '?');
    return text.size() <= 80 ? text : text.substr(0, 80) + "...";
  }

  std::string
  lower_case(std::string text)
  {
    std::transform(text.begin(), text.end(), text.begin(), [](const unsigned char c) { return std::tolower(c); });
    return text;
  }

  std::optional<double>
  to_number(const std::string &text)
  {
    char        *end   = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return !text.empty() && *end == '\0' ? std::optional<double>(value) : std::nullopt;
  }

  std::optional<double>
  metres(const std::string &unit)
  {
    static const std::map<std::string, double> known = {{"m", 1.},
                                                        {"meter", 1.},
                                                        {"meters", 1.},
                                                        {"metre", 1.},
                                                        {"metres", 1.},
                                                        {"cm", 1e-2},
                                                        {"centimeter", 1e-2},
                                                        {"centimeters", 1e-2},
                                                        {"mm", 1e-3},
                                                        {"millimeter", 1e-3},
                                                        {"millimeters", 1e-3},
                                                        {"millimetre", 1e-3},
                                                        {"millimetres", 1e-3},
                                                        {"um", 1e-6},
                                                        {"\xc2\xb5m", 1e-6},
                                                        {"\xce\xbcm", 1e-6},
                                                        {"\xb5m", 1e-6},
                                                        {"micron", 1e-6},
                                                        {"microns", 1e-6},
                                                        {"micrometer", 1e-6},
                                                        {"micrometers", 1e-6},
                                                        {"micrometre", 1e-6},
                                                        {"micrometres", 1e-6},
                                                        {"nm", 1e-9},
                                                        {"nanometer", 1e-9},
                                                        {"nanometers", 1e-9},
                                                        {"nanometre", 1e-9},
                                                        {"nanometres", 1e-9}};
    // A capital M is not "m": it may stand for mega.
    const bool is_symbol = unit.size() <= 3;
    const auto found     = known.find(is_symbol ? unit : lower_case(unit));
    return found == known.end() ? std::nullopt : std::optional<double>(found->second);
  }

  std::string
  unit_word(const double unit)
  {
    for (const auto *word : {"um", "mm", "nm"})
      if (std::abs(unit / *metres(word) - 1) < 1e-9)
        return word;
    std::ostringstream text;
    text.precision(12);
    text << unit;
    return text.str() + " m";
  }
} // namespace Stroma::Image
