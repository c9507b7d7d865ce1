#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/studies/curve.h>

#include <boost/math/interpolators/pchip.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace Stroma::Studies
{
  namespace
  {
    std::size_t
    column(const std::vector<std::string> &names, const std::string &name, const std::string &where)
    {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        throw UserError(where, "the run has no result '" + shown(name) +
                                 "' in series.csv, which has: " + shown(join(names, ", ")));
      return found - names.begin();
    }

    Curve
    read(const std::string &folder, const std::string &x, const std::string &y, const std::string &where)
    {
      std::ifstream in(folder + "/series.csv");
      std::string   line;
      std::getline(in, line);
      const auto        names = split(line, ',');
      const std::size_t of_x = column(names, x, where), of_y = column(names, y, where);
      Curve             curve;
      while (std::getline(in, line))
        {
          const auto cells = split(line, ',');
          if (cells.size() != names.size())
            continue;
          const double at    = std::strtod(cells[of_x].c_str(), nullptr),
                       value = std::strtod(cells[of_y].c_str(), nullptr);
          if (!std::isfinite(at) || !std::isfinite(value))
            continue;
          curve.x.push_back(at);
          curve.y.push_back(value);
        }
      return curve;
    }
  } // namespace

  Curve::Value
  Curve::value(const double at) const
  {
    const double inside = std::clamp(at, x.front(), x.back());
    const auto   i      = std::clamp<std::ptrdiff_t>(std::upper_bound(x.begin(), x.end(), inside) - x.begin(), 1,
                                              x.size() - 1);
    const double part   = (inside - x[i - 1]) / (x[i] - x[i - 1]);
    Value        value;
    value.y = value.by_line = (1. - part) * y[i - 1] + part * y[i];
    if (x.size() >= 4)
      value.y = boost::math::interpolators::pchip<std::vector<double>>(std::vector<double>(x),
                                                                       std::vector<double>(y))(inside);
    return value;
  }

  bool
  Curve::reaches(const double at) const
  {
    const double same = 1e-9 * (x.back() - x.front());
    return at >= x.front() - same && at <= x.back() + same;
  }

  Curve
  read_curve(const std::string &folder, const std::string &x, const std::string &y, const std::string &where,
             const MPI_Comm comm)
  {
    Curve curve;
    on_root(comm, [&] {
      curve = read(folder, x, y, where);
      if (curve.x.size() > 1 && curve.x.back() < curve.x.front())
        {
          std::reverse(curve.x.begin(), curve.x.end());
          std::reverse(curve.y.begin(), curve.y.end());
        }
      if (curve.x.size() < 2 ||
          std::adjacent_find(curve.x.begin(), curve.x.end(), std::greater_equal<>()) != curve.x.end())
        throw UserError(where, "'" + x + "' goes back or stays in the run; give the data against time_s");
    });
    return {dealii::Utilities::MPI::broadcast(comm, curve.x, 0), dealii::Utilities::MPI::broadcast(comm, curve.y, 0)};
  }
} // namespace Stroma::Studies
