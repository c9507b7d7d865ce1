#include <stroma/base/signals.h>

#include <deal.II/base/mpi.h>

#include <csignal>

namespace Stroma
{
  namespace
  {
    volatile std::sig_atomic_t stop_flag = 0;

    void
    on_stop_signal(const int signal)
    {
      stop_flag = 1;
      std::signal(signal, SIG_DFL);
    }
  } // namespace

  void
  catch_stop_signals()
  {
    std::signal(SIGINT, on_stop_signal);
    std::signal(SIGTERM, on_stop_signal);
  }

  bool
  stop_requested(const MPI_Comm comm)
  {
    return dealii::Utilities::MPI::max(static_cast<int>(stop_flag), comm) > 0;
  }
} // namespace Stroma
