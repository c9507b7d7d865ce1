#pragma once

#include <stroma/studies/plan.h>
#include <stroma/studies/run_record.h>

#include <string>
#include <vector>

namespace Stroma::Studies
{
  /**
   * The first of the names that the file gives as `Results` that no run has; "" if there is none, or if runs to come may have
   * it. Runs that set the same entries and differ in numbers only, none of them 0, have the same results, so one of each kind
   * that has finished is enough. Counts that a run tells only where they are not 0, and moduli of a body at rest, are not missed.
   * @param records one a run of the plan; empty status: still to come
   */
  std::string missing_result(const StudyPlan &plan, const std::vector<RunRecord> &records);

  /// Throws UserError for missing_result(), with the names that there are, those most like it first.
  void check_results(const StudyPlan &plan, const std::vector<RunRecord> &records);
} // namespace Stroma::Studies
