#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/output/folder.h>
#include <stroma/studies/sweep.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

namespace Stroma::Studies
{
  namespace
  {
    struct Varied
    {
      std::string              parameter;
      std::vector<std::string> values;
    };

    struct Plan
    {
      std::vector<std::string> results, reference;
      std::vector<Varied>      varied;
      std::size_t              n_runs = 1;
    };

    struct Run
    {
      std::vector<std::string> values; ///< of Plan::varied
      std::string              folder;
      Output::Summary          summary;
    };

    Plan
    read_plan(const ParameterFile &file)
    {
      Plan       plan;
      Parameters p(file);
      {
        const auto section = p.section("Study");
        plan.results       = {"reaction_force_y_N"};
        p.add("Results", plan.results, "results to tabulate");
        p.add("Reference", plan.reference, "published values of the first result, one a run; - for none");
        for (const auto &name : p.subsections())
          {
            const auto subsection = p.section(name);
            Varied     varied;
            p.add("Parameter", varied.parameter, "entry to vary, as Section/name", true);
            p.add("Values", varied.values, "its values");
            if (varied.values.empty())
              throw UserError(p.where_section(), "'Values' is missing; list the values of '" + varied.parameter + "'");
            plan.n_runs *= varied.values.size();
            plan.varied.push_back(varied);
          }
        if (plan.varied.empty())
          throw UserError(p.where_section(), "nothing to vary; add subsections with 'Parameter' and 'Values' to section Study");
        if (!plan.reference.empty() && plan.reference.size() != plan.n_runs)
          throw UserError(p.where("Reference"), "'Reference' has " + std::to_string(plan.reference.size()) +
                                                  " values for " + std::to_string(plan.n_runs) + " runs; give one a run");
      }
      return plan;
    }

    /// Values of run number @p i; the last parameter varies fastest.
    std::vector<std::string>
    values_of(const Plan &plan, std::size_t i)
    {
      std::vector<std::string> values(plan.varied.size());
      for (std::size_t v = plan.varied.size(); v-- > 0;)
        {
          values[v] = plan.varied[v].values[i % plan.varied[v].values.size()];
          i /= plan.varied[v].values.size();
        }
      return values;
    }

    double
    result_of(const Run &run, const std::string &name)
    {
      const auto found = run.summary.results.find(name);
      return found == run.summary.results.end() ? std::nan("") : found->second;
    }

    /// Header and rows as text: values, results, deviation from the reference, work and time.
    std::vector<std::vector<std::string>>
    table(const Plan &plan, const std::vector<Run> &runs)
    {
      std::vector<std::vector<std::string>> rows(1);
      for (const auto &varied : plan.varied)
        rows[0].push_back(varied.parameter.substr(varied.parameter.find_last_of('/') + 1));
      for (const auto &name : plan.results)
        rows[0].push_back(name);
      if (!plan.reference.empty())
        {
          rows[0].push_back("reference");
          rows[0].push_back("deviation_percent");
        }
      for (const std::string name : {"steps", "newton", "cg", "wall_time_s", "status"})
        rows[0].push_back(name);
      const auto text = [](const char *format, const double value) {
        char buffer[40];
        std::snprintf(buffer, sizeof(buffer), format, value);
        return std::string(buffer);
      };
      for (std::size_t i = 0; i < runs.size(); ++i)
        {
          const auto &run = runs[i];
          auto        row = run.values;
          for (const auto &name : plan.results)
            row.push_back(text("%.6g", result_of(run, name)));
          if (!plan.reference.empty())
            {
              const bool   known     = plan.reference[i] != "-";
              const double reference = known ? std::stod(plan.reference[i]) : std::nan("");
              row.push_back(plan.reference[i]);
              row.push_back(known ? text("%.2f", 100 * (result_of(run, plan.results[0]) / reference - 1)) : "-");
            }
          row.push_back(std::to_string(run.summary.n_steps));
          row.push_back(std::to_string(run.summary.newton_iterations));
          row.push_back(std::to_string(run.summary.linear_iterations));
          row.push_back(text("%.2f", run.summary.wall_time_s));
          row.push_back(run.summary.status.substr(0, run.summary.status.find(':')));
          rows.push_back(row);
        }
      return rows;
    }

    std::string
    aligned(const std::vector<std::vector<std::string>> &rows)
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

    void
    write_files(const Plan &plan, const std::vector<Run> &runs, const std::string &folder)
    {
      std::ofstream csv(folder + "/study.csv");
      for (const auto &row : table(plan, runs))
        csv << join(row, ",") << '\n';

      nlohmann::json json;
      json["runs"] = nlohmann::json::array();
      for (const auto &varied : plan.varied)
        json["parameters"].push_back(varied.parameter);
      for (const auto &run : runs)
        {
          nlohmann::json entry;
          for (std::size_t v = 0; v < plan.varied.size(); ++v)
            entry["values"][plan.varied[v].parameter] = run.values[v];
          entry["folder"] = std::filesystem::path(run.folder).filename().string();
          entry["status"] = run.summary.status;
          std::ifstream summary(run.folder + "/summary.json");
          entry["summary"] = nlohmann::json::parse(summary, nullptr, false);
          json["runs"].push_back(entry);
        }
      std::ofstream out(folder + "/study.json");
      out << json.dump(2) << '\n';
      if (!csv.flush() || !out.flush())
        throw UserError(folder, "study.csv and study.json cannot be written");
    }

    std::string
    folder_name(const Plan &plan, const std::vector<std::string> &values)
    {
      std::string name;
      for (std::size_t v = 0; v < values.size(); ++v)
        name += (v ? "," : "") + plan.varied[v].parameter.substr(plan.varied[v].parameter.find_last_of('/') + 1) + "=" +
                values[v];
      for (char &c : name)
        if (std::string(" /:*").find(c) != std::string::npos)
          c = '_';
      return name;
    }
  } // namespace

  bool
  run_study(const ParameterFile &file, const RunOptions &options, const MPI_Comm comm)
  {
    const Plan          plan  = read_plan(file);
    const ParameterFile scene = file.without("Study");

    // All cases are read before the first one runs.
    for (std::size_t v = 0; v < plan.varied.size(); ++v)
      for (const auto &value : plan.varied[v].values)
        {
          ParameterFile one = scene;
          one.set(plan.varied[v].parameter + "=" + value);
          read_only(one, comm);
        }

    Output::FolderRequest request;
    request.output         = options.output;
    request.parameter_file = file.path();
    request.overwrite      = options.overwrite;
    const Output::RunFolder folder(request, comm);

    std::vector<Run> runs;
    bool             all_finished = true;
    for (std::size_t i = 0; i < plan.n_runs; ++i)
      {
        Run           run;
        ParameterFile one = scene;
        run.values        = values_of(plan, i);
        for (std::size_t v = 0; v < plan.varied.size(); ++v)
          one.set(plan.varied[v].parameter + "=" + run.values[v]);
        RunOptions one_options = options;
        one_options.output     = folder.file(folder_name(plan, run.values));
        Log::line("Run " + std::to_string(i + 1) + " of " + std::to_string(plan.n_runs) + ": " +
                  folder_name(plan, run.values));
        const auto result = run_simulation(one, one_options, comm);
        run.folder        = result.folder;
        run.summary       = result.summary;
        runs.push_back(run);
        all_finished &= result.status == RunStatus::finished;
        on_root(comm, [&] { write_files(plan, runs, folder.path()); });
        if (result.status == RunStatus::stopped)
          break;
      }
    Log::line("\n" + aligned(table(plan, runs)));
    Log::line("Results in " + folder.path());
    return all_finished;
  }
} // namespace Stroma::Studies
