#include <stroma/base/formula.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/studies/measured.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

namespace Stroma::Studies
{
  namespace
  {
    const std::vector<std::string> symbols = {"N", "Pa", "m", "s", "J", "kg"};

    bool
    is_symbol(const std::string &text)
    {
      return std::find(symbols.begin(), symbols.end(), text) != symbols.end();
    }

    /// "m3" without its power: "m"; any other text as it is.
    std::string
    without_power(const std::string &text)
    {
      const bool has_power = text.size() > 1 && (text.back() == '2' || text.back() == '3');
      return has_power ? text.substr(0, text.size() - 1) : text;
    }

    /// "N" of "reaction_force_y_N", "m3_per_s" of "flow_rate_x_m3_per_s"; "" if there is none.
    std::string
    unit_of(const std::string &name)
    {
      auto       words = split(name, '_');
      const auto last  = [&] {
        const bool is_unit = !words.empty() && is_symbol(without_power(words.back()));
        const auto word    = is_unit ? words.back() : "";
        if (is_unit)
          words.pop_back();
        return word;
      };
      std::string unit = last();
      while (!unit.empty() && !words.empty() && words.back() == "per")
        {
          words.pop_back();
          const auto above = last();
          unit             = above + (above.empty() ? "per_" : "_per_") + unit;
        }
      return unit;
    }

    /// Multiples of a unit without a fraction that a column may have, with what turns its numbers into SI.
    std::map<std::string, double>
    simple_multiples(const std::string &unit)
    {
      const std::string             symbol = without_power(unit), power = unit.substr(symbol.size());
      const int                     n = power.empty() ? 1 : std::stoi(power);
      std::map<std::string, double> known{{unit, 1.}};
      if (!is_symbol(symbol))
        return known;
      for (const auto &[prefix, factor] :
           {std::pair("n", 1e-9), std::pair("u", 1e-6), std::pair("m", 1e-3), std::pair("k", 1e3), std::pair("M", 1e6)})
        known[prefix + symbol + power] = std::pow(factor, n);
      if (symbol == "kg")
        known = {{unit, 1.}, {"g" + power, std::pow(1e-3, n)}, {"mg" + power, std::pow(1e-6, n)}};
      if (symbol == "s")
        known.insert({{"min" + power, std::pow(60., n)}, {"h" + power, std::pow(3600., n)}});
      return known;
    }

    /// The same of any unit: of "m_per_s" those of "m" over those of "s".
    std::map<std::string, double>
    multiples(const std::string &unit)
    {
      const std::size_t at = unit.rfind("per_");
      if (at == std::string::npos)
        return simple_multiples(unit);
      const std::string             above = at == 0 ? "" : unit.substr(0, at - 1);
      std::map<std::string, double> known;
      for (const auto &[over, factor] : at == 0 ? std::map<std::string, double>{{"", 1.}} : multiples(above))
        for (const auto &[under, divisor] : simple_multiples(unit.substr(at + 4)))
          known[over + (over.empty() ? "per_" : "_per_") + under] = factor / divisor;
      return known;
    }

    /// Whether the last word of a name is a unit, or a multiple of one.
    bool
    ends_in_a_unit(const std::string &name)
    {
      const auto word = split(name, '_').back();
      for (const auto &symbol : symbols)
        if (const auto of_symbol = simple_multiples(symbol + word.substr(without_power(word).size()));
            of_symbol.count(word) > 0 && word != name)
          return true;
      return false;
    }

    /// A column of the file.
    struct Column
    {
      unsigned int number;
      double       factor;
    };

    /// The only column called @p wanted, or so with a multiple of @p unit, at its end, in the place of it.
    Column
    find_column(const std::string &where, const std::vector<std::string> &header, const std::string &wanted,
                const std::string &unit)
    {
      const std::string   stem  = wanted.substr(0, wanted.size() - unit.size());
      const auto          known = multiples(unit);
      std::vector<Column> found;
      for (unsigned int c = 0; c < header.size(); ++c)
        for (const auto &[multiple, factor] : known)
          if (header[c] == stem + multiple)
            found.push_back({c, factor});
      if (found.size() > 1)
        throw UserError(where, "columns " + std::to_string(found[0].number + 1) + " ('" +
                                 shown(header[found[0].number]) + "') and " + std::to_string(found[1].number + 1) +
                                 " ('" + shown(header[found[1].number]) + "') both give '" + shown(wanted) +
                                 "'; keep one of them");
      if (found.size() == 1)
        return found[0];
      std::string units = unit.find("per_") == std::string::npos ? "" : "multiples of its parts";
      for (const auto &[multiple, factor] : known)
        if (multiple != unit && unit.find("per_") == std::string::npos)
          units += (units.empty() ? "" : ", ") + multiple;
      throw UserError(where, "no column is called '" + shown(wanted) + "'" +
                               (units.empty() ? "" : " (or with " + units + " for " + unit + ")") +
                               "; the first line of the file must name it, and has: " + shown(join(header, ", ")));
    }

    /// The column with standard deviations of @p y: in the unit at the end of its name, else in that of the column of y.
    Column
    find_deviation(const std::string &where, const std::vector<std::string> &header, const MeasuredColumns &wanted,
                   const Column &y)
    {
      const std::string unit    = unit_of(wanted.y);
      const bool        same    = unit_of(wanted.deviation) == unit;
      Column            found   = find_column(where, header, wanted.deviation, same ? unit : "");
      const auto        known   = multiples(unit);
      const auto       &name    = header[found.number];
      const auto        its_own = std::find_if(known.begin(), known.end(), [&](const auto &multiple) {
        const auto ending = "_" + multiple.first;
        return !unit.empty() && name.size() > ending.size() &&
               name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
      });
      if (its_own == known.end() && ends_in_a_unit(name))
        throw UserError(where, "column " + std::to_string(found.number + 1) + " ('" + shown(name) +
                                 "') ends in a unit that is no multiple of that of '" + shown(wanted.y) +
                                 "'; rename it, or give the deviations in the unit of the values");
      found.factor = its_own == known.end() ? y.factor : its_own->second;
      return found;
    }

    /// Throws UserError where @p path is no file that can be read.
    void
    check_file(const std::string &path)
    {
      std::error_code code;
      const auto      status = std::filesystem::status(path, code);
      if (!std::filesystem::exists(status))
        throw UserError(path, "there is no such file, here or beside the parameter file; correct 'File'");
      if (!std::filesystem::is_regular_file(status))
        throw UserError(path, "this is no plain file; 'File' must name one with comma-separated values");
      if (!std::ifstream(path))
        throw UserError(path, "the file cannot be read; allow it, or let 'File' name another");
    }

    /// One file as it is read, line by line.
    class Reader
    {
    public:
      Reader(const std::string &path, const MeasuredColumns &columns)
        : path(path)
        , columns(columns)
        , in(path)
      {}

      Measured
      read()
      {
        std::string line;
        while (std::getline(in, line))
          {
            if (++number == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) // the byte-order mark of UTF-8
              line.erase(0, 3);
            if (!line.empty() && line.back() == '\r')
              line.pop_back();
            if (!trim(line).empty() && trim(line)[0] != '#')
              found.empty() ? read_header(split(line, ',')) : read_row(split(line, ','));
          }
        if (found.empty() || measured.x.empty())
          throw UserError(path, found.empty() ? "the file holds no line; the first must name its columns" :
                                                "the file holds no row of numbers below the names of its columns");
        return measured;
      }

    private:
      std::string
      where() const
      {
        return path + ":" + std::to_string(number);
      }

      void
      read_header(const std::vector<std::string> &names)
      {
        n_columns = names.size();
        for (const auto &name : {columns.x, columns.y})
          found.push_back(find_column(where(), names, name, unit_of(name)));
        if (!columns.deviation.empty())
          found.push_back(find_deviation(where(), names, columns, found[1]));
      }

      double
      value(const std::vector<std::string> &cells, const Column &column) const
      {
        double value = 0.;
        if (!plain_number(cells[column.number], value) || !std::isfinite(value))
          throw UserError(where(), "'" + shown(cells[column.number]) + "' in column " +
                                     std::to_string(column.number + 1) + " is no number");
        return column.factor * value;
      }

      void
      read_row(const std::vector<std::string> &cells)
      {
        if (cells.size() != n_columns)
          throw UserError(where(), "the line has " + counted(cells.size(), "number") + ", the first line names " +
                                     counted(n_columns, "column") + "; decimals are written with a point");
        auto        &x    = measured.x;
        const double next = value(cells, found[0]);
        if (x.size() > 1 ? (next - x.back()) * (x[1] - x[0]) <= 0. : x.size() == 1 && next == x[0])
          throw UserError(where(), "'" + columns.x +
                                     "' goes back or stays; sort the lines by it, and average what was " +
                                     "measured several times");
        x.push_back(next);
        measured.y.push_back(value(cells, found[1]));
        measured.line.push_back(number);
        if (found.size() < 3)
          return;
        measured.deviation.push_back(value(cells, found[2]));
        if (!(measured.deviation.back() > 0.))
          throw UserError(where(), "a standard deviation must be positive, in '" + columns.deviation + "'");
      }

      const std::string     &path;
      const MeasuredColumns &columns;
      std::ifstream          in;
      unsigned int           number    = 0;
      std::size_t            n_columns = 0;
      std::vector<Column>    found; ///< of x, y and the deviation
      Measured               measured;
    };
  } // namespace

  Measured
  read_measured(const std::string &path, const MeasuredColumns &columns, const MPI_Comm comm)
  {
    Measured measured;
    on_root(comm, [&] {
      check_file(path);
      measured = Reader(path, columns).read();
    });
    using dealii::Utilities::MPI::broadcast;
    return {broadcast(comm, measured.x, 0), broadcast(comm, measured.y, 0), broadcast(comm, measured.deviation, 0),
            broadcast(comm, measured.line, 0)};
  }
} // namespace Stroma::Studies
