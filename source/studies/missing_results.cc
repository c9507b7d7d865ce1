#include <stroma/base/text.h>
#include <stroma/base/unknown_entries.h>
#include <stroma/studies/missing_results.h>

#include <algorithm>
#include <map>
#include <set>

namespace Stroma::Studies
{
  namespace
  {
    bool
    is_number_but_zero(const std::string &text)
    {
      const auto first = text.find_first_not_of("0123456789.eE+-, ");
      return first == std::string::npos && text.find_first_of("123456789") != std::string::npos;
    }

    /// What @p run sets, with numbers left out: the same text means the same results.
    std::string
    kind_of(const PlannedRun &run)
    {
      std::string kind;
      for (const auto &assignment : run.set)
        {
          const auto sign  = assignment.find('=');
          const auto value = assignment.substr(sign + 1);
          kind += assignment.substr(0, sign) + "=";
          for (const auto &part : split(value, ','))
            kind += (is_number_but_zero(part) ? "#" : part) + ",";
          kind += "\n";
        }
      return kind;
    }

    /// Whether a run that has @p results may leave @p name out because there is nothing to tell.
    bool
    may_be_left_out(const std::map<std::string, double> &results, const std::string &name)
    {
      const std::string modulus = "apparent_modulus_";
      if (name.rfind(modulus, 0) != 0)
        return name == "free_parts" || name == "solves_below_round_off" || name == "islands";
      const auto axis = name.substr(modulus.size());
      return results.count("nominal_stress_" + axis) + results.count("shear_stress_" + axis) > 0;
    }

    /// Whether every kind of run is known: one of it has finished, or all of it have ended.
    bool
    knows_all_kinds(const StudyPlan &plan, const std::vector<RunRecord> &records)
    {
      std::set<std::string> open, finished;
      for (std::size_t i = 0; i < records.size(); ++i)
        if (records[i].finished())
          finished.insert(kind_of(plan.runs[i]));
        else if (records[i].status.empty())
          open.insert(kind_of(plan.runs[i]));
      return !finished.empty() &&
             std::all_of(open.begin(), open.end(), [&](const auto &kind) { return finished.count(kind) > 0; });
    }
  } // namespace

  std::string
  missing_result(const StudyPlan &plan, const std::vector<RunRecord> &records)
  {
    if (plan.where_results.empty() || !knows_all_kinds(plan, records))
      return "";
    for (const auto &name : plan.results)
      if (std::none_of(records.begin(), records.end(), [&](const RunRecord &record) {
            return record.finished() && (record.results.count(name) > 0 || may_be_left_out(record.results, name));
          }))
        return name;
    return "";
  }

  void
  check_results(const StudyPlan &plan, const std::vector<RunRecord> &records)
  {
    const auto name = missing_result(plan, records);
    if (name.empty())
      return;
    std::vector<std::string> known;
    for (const auto &record : records)
      if (record.finished())
        for (const auto &result : record.results)
          known.push_back(result.first);
    throw UserError(plan.where_results, "'Results' names '" + shown(name) + "', which no run has; its results are: " +
                                          join(nearest_first(known, name), ", ") +
                                          "; name one of them and go on with --resume");
  }
} // namespace Stroma::Studies
