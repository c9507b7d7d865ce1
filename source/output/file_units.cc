#include <stroma/base/parameters.h>
#include <stroma/base/text.h>
#include <stroma/output/file_units.h>

#include <cmath>

namespace Stroma::Output
{
  FileUnits::FileUnits(const Parameters &p)
  {
    for (const std::string symbol : {"m", "s", "kg", "N", "Pa"})
      symbols[symbol] = {p.file_unit(symbol), 1. / p.si_factor(symbol)};
  }

  FileUnit
  FileUnits::of(const std::string &si) const
  {
    FileUnit unit{"", 1.};
    int      sign = 1;
    for (const auto &word : split(si, '_'))
      {
        const auto        digit  = word.find_first_of("0123456789");
        const std::string symbol = word.substr(0, digit);
        const int         power  = digit == std::string::npos ? 1 : std::stoi(word.substr(digit));
        const auto        known  = symbols.find(symbol);
        sign                     = word == "per" ? -1 : sign;
        unit.name += (unit.name.empty() ? "" : "_") + (known == symbols.end() ? symbol : known->second.name) +
                     (power == 1 ? "" : std::to_string(power));
        if (known != symbols.end())
          unit.factor *= std::pow(known->second.factor, sign * power);
      }
    return unit;
  }

  std::string
  FileUnits::name(const std::string &field, const std::string &si) const
  {
    return field + (si.empty() ? "" : "_" + of(si).name);
  }
} // namespace Stroma::Output
