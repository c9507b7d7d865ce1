#pragma once

#include <deal.II/base/mpi.h>

#include <string>

namespace Stroma::Output
{
  /// What the command line says about the output folder.
  struct FolderRequest
  {
    std::string output;         ///< --output, or empty: results/<stem of the parameter file>
    std::string parameter_file; ///< gives the default name
    bool        overwrite = false;
    bool        resume    = false;
  };

  /**
   * The folder of a run, created and writable. An earlier run is never mixed with a new one: a given folder that holds
   * results (summary.json, series.csv or a checkpoint) is refused unless --resume or --overwrite is given, and without
   * a given folder the first unused of results/<stem>, results/<stem>-2, ... is taken (the newest of them to resume,
   * results/<stem> to overwrite). Overwriting removes the earlier run's own files only, never foreign ones.
   * Rank 0 decides. Throws UserError on all ranks.
   */
  class RunFolder
  {
  public:
    RunFolder(const FolderRequest &request, MPI_Comm comm);

    const std::string &
    path() const
    {
      return folder;
    }

    /// Path of a file in the folder.
    std::string
    file(const std::string &name) const
    {
      return folder + "/" + name;
    }

    /// Whether a file of this name is written by Stroma.
    static bool is_ours(const std::string &name);

  private:
    std::string folder;
  };
} // namespace Stroma::Output
