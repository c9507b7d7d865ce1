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
    constexpr std::size_t least_for_cubics = 4; ///< rows

    /// Places nearer than this are one: what was measured is rounded.
    double
    same_place(const Curve &curve)
    {
      return 1e-6 * (curve.x.back() - curve.x.front());
    }

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
    if (x.size() >= least_for_cubics)
      value.y = boost::math::interpolators::pchip<std::vector<double>>(std::vector<double>(x),
                                                                       std::vector<double>(y))(inside);
    return value;
  }

  bool
  Curve::reaches(const double at) const
  {
    const double same = same_place(*this);
    return at >= x.front() - same && at <= x.back() + same;
  }

  bool
  Curve::is_before_run(const double at) const
  {
    return !reaches(at) && (falls ? at > x.back() : at < x.front());
  }

  bool
  Curve::is_only_line(const double at) const
  {
    const double same = same_place(*this);
    return x.size() < least_for_cubics &&
           std::none_of(x.begin(), x.end(), [&](const double row) { return std::abs(row - at) <= same; });
  }

  std::string
  beyond_run(const Curve &curve, const std::string &name, const double at)
  {
    const auto &x = curve.x;
    return "'" + name + "' is " + brief(at) + " here, but goes from " + brief(curve.falls ? x.back() : x.front()) +
           " to " + brief(curve.falls ? x.front() : x.back()) + " in the run; " +
           (curve.is_before_run(at) ?
              "the data lie before its first row: check their sign and column, or leave the line out" :
              "let the scene go farther, or leave the line out");
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
          curve.falls = true;
        }
      if (curve.x.size() < 2 ||
          std::adjacent_find(curve.x.begin(), curve.x.end(), std::greater_equal<>()) != curve.x.end())
        throw UserError(where, "'" + x + "' goes back or stays in the run; give the data against time_s");
    });
    using dealii::Utilities::MPI::broadcast;
    return {broadcast(comm, curve.x, 0), broadcast(comm, curve.y, 0), broadcast(comm, curve.falls, 0)};
  }
} // namespace Stroma::Studies
