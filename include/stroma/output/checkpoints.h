#pragma once

#include <deal.II/base/mpi.h>

#include <string>

namespace Stroma::Output
{
  /// The checkpoints checkpoint_<step>.h5 of a run's folder.
  class Checkpoints
  {
  public:
    static constexpr unsigned int n_kept = 2;

    Checkpoints(const std::string &folder, MPI_Comm comm);

    /// Path of the checkpoint of @p step.
    std::string path(unsigned int step) const;

    /// Removes all but the newest n_kept and left-over temporary files; call it after a commit. Collective.
    void remove_old() const;

    /// Path of the newest checkpoint whose checksums all fit, or "" if there is none; damaged ones are named in a warning.
    /// Collective.
    std::string latest() const;

  private:
    std::string folder;
    MPI_Comm    comm;
  };
} // namespace Stroma::Output
