#include <stroma/base/text.h>
#include <stroma/output/text_file.h>
#include <stroma/studies/means.h>
#include <stroma/studies/study_table.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace Stroma::Studies
{
  namespace
  {
    using Json = nlohmann::ordered_json; // which writes what is not finite as null

    const char *const norm_names[] = {"L2", "H1", "max"};

    /// The varied entries, each once, though several cases may vary it on their own.
    std::vector<std::string>
    varied_entries(const StudyPlan &plan)
    {
      std::vector<std::string> entries;
      for (const auto &varied : plan.varied)
        if (std::find(entries.begin(), entries.end(), varied.parameter) == entries.end())
          entries.push_back(varied.parameter);
      return entries;
    }

    /// The columns that every table ends with.
    const std::vector<std::string> work_columns = {"steps",       "newton",         "cg",
                                                   "wall_time_s", "spread_s",       "times",
                                                   "cpu_time_s",  "peak_memory_MB", "status"};

    /// Their last part, or all of it where two columns would have one name.
    std::vector<std::string>
    column_names(const StudyPlan &plan)
    {
      const auto entries = varied_entries(plan);
      const auto last    = [](const std::string &entry) { return entry.substr(entry.find_last_of('/') + 1); };
      std::vector<std::string> names;
      for (const auto &entry : entries)
        {
          const auto alike    = std::count_if(entries.begin(), entries.end(),
                                              [&](const auto &other) { return last(other) == last(entry); });
          const bool is_taken = alike > 1 ||
                                std::find(work_columns.begin(), work_columns.end(), last(entry)) != work_columns.end();
          names.push_back(is_taken ? entry : last(entry));
        }
      return names;
    }

    /// What a run sets a varied entry to; "-" where it leaves it alone.
    std::string
    value_of(const StudyPlan &plan, const PlannedRun &run, const std::string &entry)
    {
      std::string value = "-";
      for (std::size_t v = 0; v < plan.varied.size(); ++v)
        if (plan.varied[v].parameter == entry && run.values[v] != "-")
          value = run.values[v];
      return value;
    }

    /// Not a number if the run failed: what it had at another time is no result.
    double
    result_of(const RunRecord &record, const std::string &name)
    {
      if (!record.finished())
        return std::nan("");
      const auto found = record.results.find(name);
      return found == record.results.end() ? std::nan("") : found->second;
    }

    /// "error" and "order" of the first field, with the name of the others.
    std::string
    column(const StudyPlan &plan, const std::string &what, const std::string &field)
    {
      return field == plan.error.compare.fields[0] ? what : what + " " + field;
    }

    std::vector<std::string>
    header(const StudyPlan &plan)
    {
      std::vector<std::string> row;
      if (plan.cases.size() > 1 || !plan.cases[0].name.empty())
        row.push_back("case");
      for (const auto &name : column_names(plan))
        row.push_back(name);
      row.insert(row.end(), plan.results.begin(), plan.results.end());
      if (!plan.published.empty())
        row.insert(row.end(), {"reference", "deviation_percent"});
      if (plan.error.wanted)
        for (const auto &field : plan.error.compare.fields)
          row.insert(row.end(), {column(plan, "error", field), column(plan, "order", field)});
      row.insert(row.end(), work_columns.begin(), work_columns.end());
      return row;
    }

    std::vector<std::string>
    row_of(const StudyPlan &plan, const std::vector<RunRecord> &records, const std::size_t i)
    {
      const auto              &run    = plan.runs[i];
      const auto              &record = records[i];
      std::vector<std::string> row;
      if (!plan.cases[run.in_case].name.empty())
        row.push_back(plan.cases[run.in_case].name);
      for (const auto &entry : varied_entries(plan))
        row.push_back(value_of(plan, run, entry));
      for (const auto &name : plan.results)
        row.push_back(text_of("%.6g", result_of(record, name)));
      if (!plan.published.empty())
        {
          const std::string &published = plan.published[i];
          row.push_back(published);
          row.push_back(published == "-" ?
                          "-" :
                          text_of("%.2f", 100 * (result_of(record, plan.results[0]) / std::stod(published) - 1)));
        }
      if (plan.error.wanted)
        for (const auto &field : plan.error.compare.fields)
          {
            row.push_back(text_of("%.4e", error_of(plan, record, field)));
            row.push_back(text_of("%.2f", order_of(plan, records, i, field)));
          }
      row.push_back(std::to_string(record.n_steps));
      row.push_back(std::to_string(record.newton_iterations));
      row.push_back(std::to_string(record.linear_iterations));
      row.push_back(text_of("%.3f", median(record.wall_times)));
      row.push_back(text_of("%.3f", spread(record.wall_times)));
      row.push_back(std::to_string(record.wall_times.size()));
      row.push_back(text_of("%.3f", median(record.cpu_times)));
      row.push_back(
        record.peak_memory_bytes > 0 ? text_of("%.1f", 1e-6 * static_cast<double>(record.peak_memory_bytes)) : "-");
      row.push_back(record.status.substr(0, record.status.find(':')));
      return row;
    }

    Json
    json_of(const StudyPlan &plan, const std::vector<RunRecord> &records, const std::size_t i,
            const std::string &folder)
    {
      const auto &run    = plan.runs[i];
      const auto &record = records[i];
      Json        json   = {{"case", plan.cases[run.in_case].name},
                            {"curve", run.curve},
                            {"folder", run.folder},
                            {"status", record.status},
                            {"wall_time_s", median(record.wall_times)},
                            {"spread_s", spread(record.wall_times)},
                            {"wall_times_s", record.wall_times},
                            {"cpu_time_s", median(record.cpu_times)},
                            {"cpu_times_s", record.cpu_times},
                            {"peak_memory_bytes", record.peak_memory_bytes},
                            {"values", Json::object()}};
      for (const auto &entry : varied_entries(plan))
        if (const auto value = value_of(plan, run, entry); value != "-")
          json["values"][entry] = value;
      if (run.axis >= 0)
        {
          json["axis"]        = plan.varied[run.axis].parameter;
          json["axis_value"]  = run.values[run.axis];
          json["axis_number"] = run.axis_number;
        }
      if (plan.error.wanted)
        {
          const auto &field = plan.error.compare.fields[0];
          json["error"]     = error_of(plan, record, field);
          json["order"]     = order_of(plan, records, i, field);
          for (const auto &[name, norms] : record.errors)
            for (unsigned int n = 0; n < 3; ++n)
              json["errors"][name][norm_names[n]] = norms[n];
        }
      std::ifstream summary(folder + "/" + run.folder + "/summary.json");
      json["summary"] = Json::parse(summary, nullptr, false);
      if (json["summary"].is_discarded())
        json["summary"] = nullptr;
      return json;
    }
  } // namespace

  /// Also files of its own.
  static Json
  write_means(const StudyPlan &plan, const std::vector<Mean> &means, const std::string &folder)
  {
    Json json = Json::array();
    for (const auto &mean : means)
      {
        Json one = {{"case", plan.cases[plan.runs[mean.first].in_case].name},
                    {"runs", mean.n_runs},
                    {"values", Json::object()},
                    {"results", Json::object()}};
        for (unsigned int v = 0; v < plan.varied.size(); ++v)
          if (mean.values[v] != "-")
            one["values"][plan.varied[v].parameter] = mean.values[v];
        for (unsigned int r = 0; r < plan.results.size(); ++r)
          one["results"][plan.results[r]] = {{"mean", mean.results[r]}, {"standard_error", mean.errors[r]}};
        json.push_back(one);
      }
    const auto rows = mean_rows(plan, means);
    Output::write_atomically(folder + "/means.csv", csv(rows));
    Output::write_atomically(folder + "/means.txt", aligned(rows));
    return json;
  }

  double
  error_of(const StudyPlan &plan, const RunRecord &record, const std::string &field)
  {
    const auto found = record.errors.find(field);
    return found == record.errors.end() ? std::nan("") : found->second[static_cast<unsigned int>(plan.error.norm)];
  }

  double
  order_of(const StudyPlan &plan, const std::vector<RunRecord> &records, const std::size_t i, const std::string &field)
  {
    const int coarser = plan.runs[i].coarser;
    return coarser < 0 ? std::nan("") :
                         observed_order(plan.runs[coarser].axis_number, error_of(plan, records[coarser], field),
                                        plan.runs[i].axis_number, error_of(plan, records[i], field));
  }

  Rows
  study_rows(const StudyPlan &plan, const std::vector<RunRecord> &records)
  {
    Rows rows{header(plan)};
    for (std::size_t i = 0; i < records.size(); ++i)
      if (!records[i].status.empty())
        rows.push_back(row_of(plan, records, i));
    return rows;
  }

  void
  write_study(const StudyPlan &plan, const std::vector<RunRecord> &records, const std::string &folder,
              const unsigned int at_once)
  {
    const auto rows = study_rows(plan, records);
    Json       json = {{"at_once", at_once}, {"runs", Json::array()}, {"parameters", Json::array()}};
    for (const auto &entry : varied_entries(plan))
      json["parameters"].push_back(entry);
    if (plan.error.wanted)
      json["error"] = {{"field", plan.error.compare.fields[0]},
                       {"norm", norm_names[static_cast<unsigned int>(plan.error.norm)]},
                       {"against", plan.error.against}};
    for (std::size_t i = 0; i < records.size(); ++i)
      if (!records[i].status.empty())
        json["runs"].push_back(json_of(plan, records, i, folder));
    if (plan.averaged >= 0)
      json["means"] = write_means(plan, means_of(plan, records), folder);
    Output::write_atomically(folder + "/study.csv", csv(rows));
    Output::write_atomically(folder + "/study.txt", aligned(rows));
    Output::write_atomically(folder + "/study.json", json.dump(2) + "\n");
  }
} // namespace Stroma::Studies
