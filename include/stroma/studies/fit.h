#pragma once

#include <stroma/simulation/simulation.h>

namespace Stroma::Studies
{
  /// What the command line says about a fit.
  struct FitOptions
  {
    std::string  output;            ///< folder, or empty for the default
    bool         overwrite = false; ///< replace earlier results
    bool         resume    = false; ///< go on with an interrupted fit
    unsigned int at_once   = 0;     ///< groups of ranks that take runs in turn; 0: as many as there are ranks or runs
  };

  /**
   * Finds the constants of section Fit (fit_plan.h) that make the runs of a scene come nearest to measured curves, by least_squares().
   * Derivatives are differences between runs, which groups of ranks take side by side. Each run lies in a folder of its own
   * with its series; an interrupted fit takes the same way again and keeps the runs that have ended. Leaves fit.json, fit.csv,
   * fit.txt and a picture; prints the table. A run that fails, or does not reach all data, is a trial that failed.
   * Returns stopped after a signal; failed if the run at the start failed, and then nothing is left, or if the search did not end or
   * runs for derivatives failed on both sides, with the best so far. Throws UserError. Collective.
   */
  RunStatus run_fit(const ParameterFile &file, const FitOptions &options, MPI_Comm comm);

  /// Reads the fit of @p file, its data and its scenes, as run_fit() does before the first run. Throws UserError. Collective.
  void check_fit(const ParameterFile &file, MPI_Comm comm);
} // namespace Stroma::Studies
