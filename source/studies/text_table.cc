#include <stroma/output/text_file.h>
#include <stroma/studies/text_table.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace Stroma::Studies
{
  std::string
  aligned(const Rows &rows)
  {
    std::vector<std::size_t> width(rows[0].size(), 0);
    for (const auto &row : rows)
      for (std::size_t c = 0; c < row.size(); ++c)
        width[c] = std::max(width[c], row[c].size());
    std::string text;
    for (const auto &row : rows)
      {
        for (std::size_t c = 0; c < row.size(); ++c)
          text += std::string(2 + width[c] - row[c].size(), ' ') + row[c];
        text += '\n';
      }
    return text;
  }

  std::string
  csv(const Rows &rows)
  {
    std::string text;
    for (const auto &row : rows)
      for (std::size_t c = 0; c < row.size(); ++c)
        text += Output::csv_cell(row[c]) + (c + 1 < row.size() ? "," : "\n");
    return text;
  }

  std::string
  text_of(const char *format, const double value)
  {
    if (std::isnan(value))
      return "-";
    char buffer[40];
    std::snprintf(buffer, sizeof(buffer), format, value);
    return buffer;
  }
} // namespace Stroma::Studies
