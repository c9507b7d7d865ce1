#include <stroma/base/parameters.h>
#include <stroma/base/text.h>

#include <cctype>
#include <cmath>

namespace Stroma
{
  namespace
  {
    /// Known units of measure and their SI value, by what they measure.
    const std::map<std::string, std::vector<std::pair<std::string, double>>> known_units = {
      {"Length", {{"m", 1.}, {"mm", 1e-3}, {"um", 1e-6}, {"nm", 1e-9}}},
      {"Time", {{"s", 1.}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60.}, {"h", 3600.}}},
      {"Mass", {{"kg", 1.}, {"g", 1e-3}, {"mg", 1e-6}, {"ug", 1e-9}, {"ng", 1e-12}, {"pg", 1e-15}}},
      {"Force", {{"N", 1.}, {"mN", 1e-3}, {"uN", 1e-6}, {"nN", 1e-9}, {"pN", 1e-12}}},
      {"Stress", {{"Pa", 1.}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}, {"mPa", 1e-3}}}};
  } // namespace

  void
  Parameters::read_units()
  {
    const auto section = this->section("Units", "units of the numbers in this file; results are always in SI");
    const std::map<std::string, std::string> symbols = {
      {"Length", "m"}, {"Time", "s"}, {"Mass", "kg"}, {"Force", "N"}, {"Stress", "Pa"}};
    for (const auto &[quantity, symbol] : symbols)
      {
        double                                      factor  = 1;
        std::vector<std::pair<std::string, double>> choices = known_units.at(quantity);
        add_choice(quantity, factor, "unit in which this file gives every " + quantity, choices);
        base_units[symbol] = factor;
        for (const auto &[name, value] : choices)
          if (value == factor)
            unit_names[symbol] = name;
      }
  }

  std::string
  Parameters::file_unit(const std::string &unit) const
  {
    std::string text, symbol;
    for (const char c : unit + " ")
      if (std::isalpha(static_cast<unsigned char>(c)))
        symbol += c;
      else
        {
          text += unit_names.count(symbol) > 0 ? unit_names.at(symbol) : symbol;
          symbol.clear();
          text += c;
        }
    return trim(text);
  }

  std::string
  Parameters::in_file_units(const double value, const std::string &unit) const
  {
    return brief(value / si_factor(unit)) + (unit.empty() ? "" : " " + file_unit(unit));
  }

  std::string
  Parameters::in_brackets(const std::string &unit) const
  {
    return unit.empty() ? "" : " [" + file_unit(unit) + "]";
  }

  double
  Parameters::si_factor(const std::string &unit) const
  {
    double factor = 1;
    for (std::size_t begin = 0, power_sign = 1; begin < unit.size();)
      {
        const std::size_t end    = std::min(unit.find_first_of("*/", begin), unit.size());
        const auto        symbol = split(unit.substr(begin, end - begin), '^');
        const int         power  = symbol.size() > 1 ? std::stoi(symbol[1]) : 1;
        const double      base   = symbol[0] == "1" ? 1. : base_units.at(symbol[0]);
        factor *= std::pow(base, (power_sign == 1 ? 1 : -1) * power);
        power_sign = (end < unit.size() && unit[end] == '/') ? 0 : 1;
        begin      = end + 1;
      }
    return factor;
  }
} // namespace Stroma
