#include <stroma/base/formula.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/studies/measured.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

namespace Stroma::Studies
{
  namespace
  {
    /// "N" of "reaction_force_y_N"; units of one word only have multiples.
    std::string
    unit_of(const std::string &name)
    {
      const std::string unit = name.substr(name.find_last_of('_') + 1);
      return unit == "N" || unit == "Pa" || unit == "m" || unit == "s" || unit == "J" ? unit : "";
    }

    /// Multiples of a unit that a column may have, with what turns its numbers into SI.
    std::map<std::string, double>
    multiples(const std::string &unit)
    {
      std::map<std::string, double> known{{unit, 1.}};
      if (unit.empty())
        return known;
      for (const auto &[prefix, factor] :
           {std::pair("n", 1e-9), std::pair("u", 1e-6), std::pair("m", 1e-3), std::pair("k", 1e3), std::pair("M", 1e6)})
        known[prefix + unit] = factor;
      if (unit == "s")
        known.insert({{"min", 60.}, {"h", 3600.}});
      return known;
    }

    /// A column of the file.
    struct Column
    {
      unsigned int number;
      double       factor;
    };

    Column
    find_column(const std::string &where, const std::vector<std::string> &header, const std::string &wanted)
    {
      const std::string unit  = unit_of(wanted);
      const std::string stem  = wanted.substr(0, wanted.size() - unit.size());
      const auto        known = multiples(unit);
      for (unsigned int c = 0; c < header.size(); ++c)
        for (const auto &[multiple, factor] : known)
          if (header[c] == stem + multiple)
            return {c, factor};
      std::string units;
      for (const auto &[multiple, factor] : known)
        units += multiple == unit ? "" : (units.empty() ? "" : ", ") + multiple;
      throw UserError(where, "no column is called '" + shown(wanted) + "'" +
                               (units.empty() ? "" : " (or with " + units + " for " + unit + ")") +
                               "; the first line of the file must name it, and has: " + shown(join(header, ", ")));
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
            ++number;
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
        for (const auto &name : {columns.x, columns.y, columns.deviation})
          if (!name.empty())
            found.push_back(find_column(where(), names, name));
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
          throw UserError(where(), "the line has " + std::to_string(cells.size()) + " numbers, the first line names " +
                                     std::to_string(n_columns) + " columns; decimals are written with a point");
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
    on_root(comm, [&] { measured = Reader(path, columns).read(); });
    using dealii::Utilities::MPI::broadcast;
    return {broadcast(comm, measured.x, 0), broadcast(comm, measured.y, 0), broadcast(comm, measured.deviation, 0),
            broadcast(comm, measured.line, 0)};
  }
} // namespace Stroma::Studies
