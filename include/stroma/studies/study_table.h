#pragma once

#include <stroma/studies/plan.h>
#include <stroma/studies/run_record.h>
#include <stroma/studies/text_table.h>

namespace Stroma::Studies
{
  /// Error of a run for the first or another field in the plan's norm, relative; not a number if unknown.
  double error_of(const StudyPlan &plan, const RunRecord &record, const std::string &field);

  /// Observed order between run @p i and the next coarser one of its curve; not a number if unknown.
  double order_of(const StudyPlan &plan, const std::vector<RunRecord> &records, std::size_t i,
                  const std::string &field);

  /// One row a run that has ended: case, values, results, deviation from published ones, errors, orders, work and time.
  Rows study_rows(const StudyPlan &plan, const std::vector<RunRecord> &records);

  /// Leaves study.csv, study.json and study.txt in @p folder. Local to the rank. @p at_once how many runs shared the machine.
  void write_study(const StudyPlan &plan, const std::vector<RunRecord> &records, const std::string &folder,
                   unsigned int at_once);
} // namespace Stroma::Studies
