#include <stroma/base/text.h>
#include <stroma/output/collective.h>
#include <stroma/output/summary.h>
#include <stroma/output/text_file.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace Stroma::Output
{
  namespace
  {
    std::string
    now()
    {
      const std::time_t  time = std::time(nullptr);
      std::ostringstream text;
      text << std::put_time(std::localtime(&time), "%Y-%m-%dT%H:%M:%S%z");
      return text.str();
    }

    /// What is not finite is written as null.
    template <typename Pairs>
    nlohmann::ordered_json
    numbers(const Pairs &pairs)
    {
      nlohmann::ordered_json object = nlohmann::ordered_json::object();
      for (const auto &[name, value] : pairs)
        object[name] = value;
      return object;
    }

    std::string
    to_json(const Summary &s)
    {
      nlohmann::ordered_json json = {{"status", s.status},
                                     {"title", s.title},
                                     {"method", s.method},
                                     {"parameter_file", s.parameter_file},
                                     {"version", s.version},
                                     {"date", s.date.empty() ? now() : s.date},
                                     {"dimension", s.dimension},
                                     {"n_ranks", s.n_ranks},
                                     {"n_points", s.n_points},
                                     {"n_cells", s.n_cells},
                                     {"n_dofs", s.n_dofs},
                                     {"n_steps", s.n_steps},
                                     {"newton_iterations", s.newton_iterations},
                                     {"linear_iterations", s.linear_iterations},
                                     {"residual_evaluations", s.residual_evaluations},
                                     {"wall_time_s", s.wall_time_s},
                                     {"phases", numbers(s.phases)},
                                     {"peak_memory_bytes", s.peak_memory_bytes},
                                     {"bytes_per_point", s.bytes_per_point},
                                     {"materials", s.materials},
                                     {"laws", s.laws},
                                     {"used", s.used},
                                     {"left_out", s.left_out},
                                     {"results", numbers(s.results)},
                                     {"without_value", s.without_value()}};
      if (!s.ending.empty())
        json["ending"] = s.ending;
      return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    }

    /// Two columns.
    class Table
    {
    public:
      explicit Table(std::ostream &out)
        : out(out)
      {}

      void
      line(const std::string &name, const std::string &value)
      {
        if (!value.empty())
          out << "  " << std::left << std::setw(34) << name << ' ' << value << '\n';
      }

      void
      count(const std::string &name, const std::uint64_t value)
      {
        if (value > 0)
          line(name, std::to_string(value));
      }

      void
      quantity(const std::string &name, const double value, const std::string &unit = "")
      {
        std::ostringstream text;
        text << std::setprecision(6) << value << (unit.empty() ? "" : " ") << unit;
        line(name, std::isfinite(value) ? text.str() : "none");
      }

    private:
      std::ostream &out;
    };

    void
    print_costs(Table &table, const Summary &s)
    {
      table.quantity("wall time", s.wall_time_s, "s");
      for (const auto &[name, seconds] : s.phases)
        table.quantity("  " + name, seconds, "s");
      if (s.peak_memory_bytes > 0)
        table.quantity("peak memory, all ranks", 1e-6 * static_cast<double>(s.peak_memory_bytes), "MB");
      if (std::isfinite(s.bytes_per_point))
        table.quantity("memory a point", s.bytes_per_point, "bytes");
    }
  } // namespace

  void
  Summary::write(const std::string &path, const MPI_Comm comm) const
  {
    on_root(comm, [&] { write_atomically(path, to_json(*this)); });
  }

  std::vector<std::string>
  Summary::without_value() const
  {
    std::vector<std::string> names;
    for (const auto &[name, value] : results)
      if (!std::isfinite(value))
        names.push_back(name);
    return names;
  }

  std::string
  Summary::status_in(const std::string &path)
  {
    std::ifstream in(path);
    const auto    json = nlohmann::json::parse(in, nullptr, false);
    return json.is_object() && json.contains("status") && json["status"].is_string() ?
             json["status"].get<std::string>() :
             "";
  }

  void
  Summary::print(std::ostream &out) const
  {
    Table table(out);
    table.line("status", status);
    table.line("scene", title);
    table.line("parameter file", parameter_file);
    table.line("method", method + " in " + std::to_string(dimension) + "D on " + Stroma::counted(n_ranks, "rank"));
    table.line("Stroma", version + ", " + (date.empty() ? now() : date));
    table.count("material points", n_points);
    table.count("cells", n_cells);
    table.count("unknowns", n_dofs);
    table.count("steps", n_steps);
    table.count("Newton iterations", newton_iterations);
    table.count("linear iterations", linear_iterations);
    table.count("residual evaluations", residual_evaluations);
    print_costs(table, *this);
    for (const auto &[name, value] : results)
      table.quantity(name, value);
  }
} // namespace Stroma::Output
