#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace Stroma
{
  /// Output for people, on rank 0 only. `stroma run --quiet` silences it.
  class Log
  {
  public:
    /// Call once, after MPI has been initialised.
    static void start(bool quiet);

    /// One line, flushed at once.
    static void line(const std::string &text);

    /// A warning: printed also when quiet, to standard error.
    static void warning(const std::string &text);

  private:
    static bool quiet;
  };

  /**
   * Wall time by named phases. Phases do not overlap: entering one inside another stops the outer's clock meanwhile,
   * so the seconds add up to the time spent in all of them.
   */
  class Timers
  {
  public:
    Timers();

    /// Runs a phase while it lives.
    class Scope
    {
    public:
      Scope(Timers &timers, const std::string &phase);
      ~Scope();
      Scope(const Scope &)            = delete;
      Scope &operator=(const Scope &) = delete;

    private:
      Timers &timers;
    };

    [[nodiscard]] Scope
    scope(const std::string &phase)
    {
      return Scope(*this, phase);
    }

    /// Seconds of every phase entered so far on this rank.
    const std::map<std::string, double> &
    phases() const
    {
      return seconds;
    }

    /// Seconds since construction.
    double total() const;

  private:
    using Clock = std::chrono::steady_clock;
    void charge();

    std::map<std::string, double> seconds;
    std::vector<std::string>      running;
    Clock::time_point             start, last;
  };

  /// Largest resident memory of this process so far, in bytes.
  std::size_t peak_memory_bytes();
} // namespace Stroma
