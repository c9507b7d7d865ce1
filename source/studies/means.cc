#include <stroma/studies/means.h>

#include <cmath>

namespace Stroma::Studies
{
  namespace
  {
    /// Mean and standard error of the finite ones of @p numbers.
    std::pair<double, double>
    mean_and_error(const std::vector<double> &numbers)
    {
      double sum = 0., squares = 0.;
      for (const double number : numbers)
        sum += number;
      const double n = numbers.size(), mean = sum / n; // not a number of none
      for (const double number : numbers)
        squares += (number - mean) * (number - mean);
      return {mean, std::sqrt(squares / (n - 1.) / n)};
    }

    void
    set_results(Mean &mean, const StudyPlan &plan, const std::vector<const RunRecord *> &records)
    {
      mean.n_runs = records.size();
      for (const auto &name : plan.results)
        {
          std::vector<double> numbers;
          for (const auto *record : records)
            if (const auto found = record->results.find(name); found != record->results.end())
              numbers.push_back(found->second);
          const auto [value, error] = mean_and_error(numbers);
          mean.results.push_back(value);
          mean.errors.push_back(error);
        }
    }
  } // namespace

  std::vector<Mean>
  means_of(const StudyPlan &plan, const std::vector<RunRecord> &records)
  {
    std::vector<Mean> means;
    if (plan.averaged < 0)
      return means;
    std::vector<std::vector<const RunRecord *>> members;
    for (unsigned int i = 0; i < plan.runs.size(); ++i)
      {
        auto values           = plan.runs[i].values;
        values[plan.averaged] = "-";
        unsigned int m        = 0;
        while (m < means.size() &&
               (means[m].values != values || plan.runs[means[m].first].in_case != plan.runs[i].in_case))
          ++m;
        if (m == means.size())
          {
            means.emplace_back();
            means.back().first  = i;
            means.back().values = values;
            members.emplace_back();
          }
        if (records[i].finished())
          members[m].push_back(&records[i]);
      }
    for (unsigned int m = 0; m < means.size(); ++m)
      set_results(means[m], plan, members[m]);
    return means;
  }

  Rows
  mean_rows(const StudyPlan &plan, const std::vector<Mean> &means)
  {
    const bool               has_cases = !plan.cases[0].name.empty();
    std::vector<std::string> header;
    if (has_cases)
      header.push_back("case");
    for (int v = 0; v < static_cast<int>(plan.varied.size()); ++v)
      if (v != plan.averaged)
        header.push_back(plan.varied[v].parameter);
    for (const auto &name : plan.results)
      header.insert(header.end(), {name, "standard_error"});
    header.push_back("runs");
    Rows rows{header};
    for (const auto &mean : means)
      {
        std::vector<std::string> row;
        if (has_cases)
          row.push_back(plan.cases[plan.runs[mean.first].in_case].name);
        for (int v = 0; v < static_cast<int>(plan.varied.size()); ++v)
          if (v != plan.averaged)
            row.push_back(mean.values[v]);
        for (unsigned int r = 0; r < plan.results.size(); ++r)
          row.insert(row.end(), {text_of("%.6g", mean.results[r]), text_of("%.2g", mean.errors[r])});
        row.push_back(std::to_string(mean.n_runs));
        rows.push_back(row);
      }
    return rows;
  }
} // namespace Stroma::Studies
