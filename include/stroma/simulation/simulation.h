#pragma once

#include <stroma/base/parameters.h>
#include <stroma/output/summary.h>

#include <mpi.h>

#include <limits>
#include <string>

namespace Stroma
{
  /// What the command line says about a run.
  struct RunOptions
  {
    std::string output;            ///< folder, or empty for the default
    bool        overwrite = false; ///< replace earlier results
    bool        resume    = false; ///< continue from the newest checkpoint
    bool        check     = false; ///< stop once everything has been read and found usable
  };

  /// How a run ended.
  enum class RunStatus
  {
    finished,
    checked, ///< only checked
    stopped, ///< by a signal; can be resumed
    failed   ///< physics or solver; the last good state was saved
  };

  struct RunResult
  {
    RunStatus       status;
    Output::Summary summary;
    std::string     folder;
    bool            is_of_output = false; ///< whether it failed because a file could not be written
    bool            is_saved = false; ///< whether a checkpoint of the last good state is there, if it stopped or failed
    double          cpu_time_s = std::numeric_limits<double>::quiet_NaN(); ///< of all ranks, of a run that ended
  };

  /**
   * Reads a scene, sets it up, makes the output folder, solves it with the method it names, and leaves all results in the output folder: summary.json,
   * series.csv, fields with a .pvd, parameters.prm and checkpoints. Throws UserError for
   * unusable input, with nothing written, and OutputError if the disk takes nothing from the start. Collective.
   */
  RunResult run_simulation(const ParameterFile &file, const RunOptions &options, MPI_Comm comm);

  /// Reads a scene with everything that it names and throws UserError if it is unusable; makes no grid. Collective.
  void read_only(const ParameterFile &file, MPI_Comm comm);

  /// A documented parameter file of every entry that a scene with the choices in @p file has. Collective.
  std::string parameter_template(const ParameterFile &file, MPI_Comm comm);
} // namespace Stroma
