#pragma once

#include <stroma/studies/curve.h>
#include <stroma/studies/fit_plan.h>

#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// What a fit has come to.
  struct FitReport
  {
    LeastSquares             found;
    std::vector<Curve>       at_start, at_end; ///< of each data set
    unsigned int             n_runs = 0;
    std::vector<std::string> warnings;
  };

  /// A table for people: each constant with its interval.
  std::string fit_table(const FitPlan &plan, const FitReport &report);

  /// Writes fit.json, fit.csv (measured and modelled values) and fit.txt. Local to the calling rank; throws OutputError.
  void write_fit(const FitPlan &plan, const FitReport &report, const std::string &folder);
} // namespace Stroma::Studies
