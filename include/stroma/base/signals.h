#pragma once

#include <mpi.h>

namespace Stroma
{
  /// Turns SIGINT and SIGTERM into a request to stop after the present step; a second signal ends the process at once.
  void catch_stop_signals();

  /// Whether any rank was asked to stop; collective.
  bool stop_requested(MPI_Comm comm);
} // namespace Stroma
