#pragma once

#include <stroma/studies/run_record.h>

namespace Stroma::Studies
{
  /// How runs of a study deal with what lies in their folders.
  struct KeptRuns
  {
    bool overwrite = false; ///< earlier results are replaced
    bool resume    = false; ///< a run that has ended is kept
  };

  /**
   * Runs @p file in the folder @p path and leaves its record there, unless, to resume, there is one of a run that ended with
   * the same parameters. Returns finished, failed or stopped; @p record is that of a run that has ended. Throws UserError, and
   * OutputError if a file could not be written. Collective.
   */
  RunStatus run_or_keep(const ParameterFile &file, const std::string &path, const KeptRuns &kept, RunRecord &record,
                        MPI_Comm comm);
} // namespace Stroma::Studies
