#include <stroma/base/characters.h>
#include <stroma/base/log.h>

#include <deal.II/base/mpi.h>

#include <sys/resource.h>

#include <iostream>

namespace Stroma
{
  bool Log::quiet = false;

  void
  Log::start(const bool be_quiet)
  {
    quiet = be_quiet;
  }

  void
  Log::line(const std::string &text)
  {
    if (!quiet && dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::cout << text << std::endl;
  }

  void
  Log::warning(const std::string &text)
  {
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::cerr << "stroma: warning: " << printable(text) << std::endl;
  }

  Timers::Timers()
    : start(Clock::now())
    , last(start)
  {}

  void
  Timers::charge()
  {
    const auto now = Clock::now();
    if (!running.empty())
      seconds[running.back()] += std::chrono::duration<double>(now - last).count();
    last = now;
  }

  Timers::Scope::Scope(Timers &timers, const std::string &phase)
    : timers(timers)
  {
    timers.charge();
    timers.running.push_back(phase);
  }

  Timers::Scope::~Scope()
  {
    timers.charge();
    timers.running.pop_back();
  }

  double
  Timers::total() const
  {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  std::size_t
  peak_memory_bytes()
  {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  }
} // namespace Stroma
