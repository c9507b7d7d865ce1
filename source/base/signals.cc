#include <stroma/base/signals.h>

#include <deal.II/base/mpi.h>

#include <cerrno>
#include <csignal>
#include <ctime>

#include <unistd.h>

namespace Stroma
{
  namespace
  {
    // What the handler reads and writes; it may only call what is safe in a signal.
    volatile std::sig_atomic_t stop_flag = 0, is_polite = 0, is_first_rank = 0;
    timespec                   first_signal;

    double
    seconds_since_first_signal()
    {
      timespec now;
      clock_gettime(CLOCK_MONOTONIC, &now);
      return double(now.tv_sec - first_signal.tv_sec) + 1e-9 * double(now.tv_nsec - first_signal.tv_nsec);
    }

    void
    say(const char *text, const std::size_t length)
    {
      const int     before  = errno;
      const ssize_t ignored = write(STDERR_FILENO, text, length);
      static_cast<void>(ignored);
      errno = before;
    }

    void
    on_stop_signal(int)
    {
      constexpr char polite[] = "stroma: stopping after this step; a second signal ends it at once, without saving\n";
      if (is_polite == 0 || (stop_flag != 0 && seconds_since_first_signal() >= 1.))
        _exit(stopped_by_signal);
      if (stop_flag == 0)
        {
          clock_gettime(CLOCK_MONOTONIC, &first_signal);
          if (is_first_rank != 0)
            say(polite, sizeof(polite) - 1);
        }
      stop_flag = 1;
    }
  } // namespace

  void
  catch_stop_signals()
  {
    std::signal(SIGXFSZ, SIG_IGN); // a file that grows beyond the user's limit is a failed write, as on a full disk
    static bool first_call = true, is_ignored[NSIG];
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1})
      {
        struct sigaction action = {}, before = {};
        action.sa_handler = &on_stop_signal;
        action.sa_flags   = SA_RESTART;
        sigemptyset(&action.sa_mask);
        if (first_call)
          is_ignored[signal] = sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
        sigaction(signal, is_ignored[signal] ? nullptr : &action, nullptr);
      }
    first_call = false;
  }

  StopPolitely::StopPolitely(const MPI_Comm comm)
  {
    is_first_rank = dealii::Utilities::MPI::this_mpi_process(comm) == 0 ? 1 : 0;
    is_polite     = 1;
  }

  StopPolitely::~StopPolitely()
  {
    is_polite = 0;
  }

  bool
  stop_requested(const MPI_Comm comm)
  {
    return dealii::Utilities::MPI::max(static_cast<int>(stop_flag), comm) > 0;
  }
} // namespace Stroma
