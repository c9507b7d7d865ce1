#pragma once

#include <stroma/simulation/simulation.h>

namespace Stroma::Studies
{
  /// What the command line says about a study.
  struct StudyOptions
  {
    std::string  output;            ///< folder, or empty for the default
    bool         overwrite = false; ///< replace earlier results
    bool         resume    = false; ///< go on with an interrupted study
    unsigned int at_once   = 1;     ///< groups of ranks that take runs in turn
  };

  /**
   * Runs a scene for all combinations of the values that its `Study` section lists, for each of its cases:
   *   subsection Study
   *     set Results          = reaction_force_y_N    # columns of the table
   *     set Reference        = 65e-9, 74.7e-9        # optional: published values of the first result, one a run; - for none
   *     set Repeat           = 3                     # a run below this wall time [s] is done so often, for its time
   *     set Repeat below     = 5
   *     subsection Cases                             # optional: one subsection a curve
   *       subsection Q2
   *         set Set = Method = fem, FEM/Degree = 2
   *       end
   *     end
   *     subsection resolution                        # one subsection a varied entry, values from coarse to fine
   *       set Parameter = Constants/cells
   *       set Values    = 8, 16
   *       set Only      = Q2                         # optional: names of cases
   *     end
   *     subsection Error                             # optional: work-precision
   *       set Against = reference                    # or exact, or a run's folder or a stored reference
   *       set Fields  = displacement_m
   *       set Norm    = L2                           # or H1, max
   *     end
   *     subsection Reference
   *       set Set = Constants/cells = 64             # the run that the others are compared with
   *     end
   *   end
   * The last parameter varies fastest. Leaves each run in a folder of its own, and study.csv, study.json, study.txt and
   * pictures beside them; prints the table. Runs follow one another, so that their times can be compared, unless
   * options.at_once > 1. A run that was interrupted is done anew by --resume, runs that have ended are kept if their
   * parameters are the same. Returns stopped after a signal, failed if a run failed. Throws UserError. Collective.
   */
  RunStatus run_study(const ParameterFile &file, const StudyOptions &options, MPI_Comm comm);

  /// Reads the study of @p file, and its scene with each case and each value, as run_study() does before the first run. Returns the
  /// number of runs. Throws UserError. Collective.
  std::size_t check_study(const ParameterFile &file, MPI_Comm comm);
} // namespace Stroma::Studies
