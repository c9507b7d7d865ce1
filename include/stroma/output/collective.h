#pragma once

#include <deal.II/base/mpi.h>

#include <functional>
#include <string>

namespace Stroma::Output
{
  /// Throws UserError with the message of the lowest rank whose @p error is not empty, on all ranks; returns if all
  /// are empty. Collective.
  void throw_if_any(const std::string &error, MPI_Comm comm);

  /// Runs @p work on rank 0 only. What it throws becomes a UserError on all ranks. Collective.
  void on_rank_zero(MPI_Comm comm, const std::function<void()> &work);
} // namespace Stroma::Output
