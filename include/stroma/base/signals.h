#pragma once

#include <mpi.h>

namespace Stroma
{
  /// Exit code of a program that a signal stopped.
  constexpr int stopped_by_signal = 3;

  /**
   * Takes SIGINT, SIGTERM, SIGHUP and SIGUSR1 (which mpirun hands on without ending the ranks) as requests to stop, unless
   * they were ignored (nohup). While nothing is to be saved the process ends at once with stopped_by_signal; a StopPolitely
   * makes it wait. Call it first, also before MPI is there, and again after MPI and what comes with it.
   */
  void catch_stop_signals();

  /**
   * While it lives, a signal only asks to stop: rank 0 says so at once, and who owns the state acts on stop_requested(). A
   * second signal a second or more later ends the process at once ('timeout' sends the first one twice).
   */
  class StopPolitely
  {
  public:
    explicit StopPolitely(MPI_Comm comm);
    ~StopPolitely();
    StopPolitely(const StopPolitely &)            = delete;
    StopPolitely &operator=(const StopPolitely &) = delete;
  };

  /// Whether any rank was asked to stop; collective.
  bool stop_requested(MPI_Comm comm);
} // namespace Stroma
