#pragma once

#include <stroma/studies/plan.h>
#include <stroma/studies/run_record.h>
#include <stroma/studies/text_table.h>

namespace Stroma::Studies
{
  /// The runs of a study that differ only in the entry over whose values means are taken.
  struct Mean
  {
    unsigned int        first  = 0; ///< number of one of them in the plan
    unsigned int        n_runs = 0; ///< of those that have finished
    std::vector<double> results;    ///< mean of each of the plan's results; not a number without a run
    std::vector<double>
      errors; ///< standard error of each: standard deviation over sqrt(n), with n - 1 degrees of freedom
    std::vector<std::string> values; ///< of each Varied; "-" for the one that is averaged
  };

  /// In the order of the plan; none where the study takes no means.
  std::vector<Mean> means_of(const StudyPlan &plan, const std::vector<RunRecord> &records);

  /// One row a mean: case, values, and for each result mean and standard error.
  Rows mean_rows(const StudyPlan &plan, const std::vector<Mean> &means);
} // namespace Stroma::Studies
