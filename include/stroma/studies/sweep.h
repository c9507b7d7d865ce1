#pragma once

#include <stroma/simulation/simulation.h>

namespace Stroma::Studies
{
  /**
   * Runs a scene for all combinations of the values that its `Study` section lists:
   *   subsection Study
   *     set Results          = reaction_force_y_N    # columns of the table
   *     set Reference        = 65e-9, 74.7e-9        # optional: published values of the first result, one a run; - for none
   *     subsection stiffness                         # one subsection a varied entry
   *       set Parameter = Constants/ratio
   *       set Values    = 0.5, 1
   *     end
   *   end
   * The last parameter varies fastest. Leaves each run in a folder of its own, and study.csv and study.json beside them;
   * prints the table. Returns false if a run failed. Throws UserError. Collective.
   */
  bool run_study(const ParameterFile &file, const RunOptions &options, MPI_Comm comm);
} // namespace Stroma::Studies
