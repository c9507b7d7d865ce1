#pragma once

#include <deal.II/base/mpi.h>

#include <string>
#include <vector>

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
   * The folder of a run. An earlier run is never mixed with a new one: a given folder that holds results is refused unless
   * --resume or --overwrite is given, and without a given folder the first unused of results/<stem>, results/<stem>-2, ...
   * is taken (the newest of them to resume, results/<stem> to overwrite).
   *
   * The constructor refuses what cannot be used and touches nothing; open() makes the folder and, to overwrite, removes the
   * earlier run's files. So call open() only when the scene is known to be usable. Rank 0 decides. Both throw UserError on
   * all ranks.
   */
  class RunFolder
  {
  public:
    RunFolder(const FolderRequest &request, MPI_Comm comm);

    /// Collective.
    void open();

    /// Known after open(), and before it where it does not depend on what other runs do meanwhile.
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
    FolderRequest request;
    MPI_Comm      comm;
    std::string   folder;
  };

  /// Whether a folder holds results of a run or study. Local to the rank.
  bool holds_results(const std::string &folder);

  /// Removes the files of a run that lie in a folder and in its states/, and these two where they are empty then. Other
  /// files stay, and links are not followed. Local to the rank. Throws UserError.
  void remove_run(const std::string &folder);

  /// Removes the checkpoints and states of later steps than @p step: a run that continues from there takes another way.
  /// Collective.
  void remove_later_steps(const std::string &folder, unsigned int step, MPI_Comm comm);

  /// The files of series that lie in a folder ("points.pvd"), for a run that continues. Rank 0's listing. Collective.
  std::vector<std::string> series_files(const std::string &folder, MPI_Comm comm);

  /// The path of @p name in @p folder. This is the only way from a name of the user to a path: throws UserError, beginning
  /// with @p where, unless the name is that of one entry right inside the folder.
  std::string path_inside(const std::string &folder, const std::string &name, const std::string &where);

  /// The name of the file of a state after @p step steps, in states/; and whether a name is of that form.
  std::string state_name(unsigned int step);
  bool        is_state(const std::string &name);
} // namespace Stroma::Output
