// Runs the program many times from one initialised process: a start costs .7 s, a fork a few milliseconds.
//
// A line of standard input is a case, {"arguments": [...], "folder": F, "seconds": S, "memory": B, "signals": [[s, after]]}:
// a child runs `stroma arguments` in folder F with at most B bytes; its output goes to F/../stdout and F/../stderr. After S
// seconds it is asked to stop (SIGTERM), `patience` later again (a step may be long; a second signal ends it at once), and at
// last it is killed. A line of standard output answers, {"code": c, "signal": s, "asked": b, "killed": b, "elapsed": seconds}.

#include <stroma/base/signals.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <sys/resource.h>
#include <sys/wait.h>

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "../run_words.h"

namespace
{
  using nlohmann::json;
  using Clock = std::chrono::steady_clock;

  constexpr double patience = 5.; ///< seconds that a program may take to stop when it is asked to

  void
  redirect(const int descriptor, const std::string &path, const int flags)
  {
    const int file = open(path.c_str(), flags, 0644);
    if (file < 0 || dup2(file, descriptor) < 0)
      _exit(97);
    close(file);
  }

  /// The child: becomes `stroma` with the case's arguments. Exit code 4: an exception that the program did not foresee.
  [[noreturn]] void
  run_case(const json &wanted)
  {
    const std::string folder = wanted.at("folder");
    const rlim_t      memory = wanted.at("memory").get<std::uint64_t>();
    const rlimit      limit{memory, memory};
    if (chdir(folder.c_str()) != 0 || setrlimit(RLIMIT_AS, &limit) != 0)
      _exit(97);
    redirect(0, "/dev/null", O_RDONLY);
    redirect(1, folder + "/../stdout", O_WRONLY | O_CREAT | O_TRUNC);
    redirect(2, folder + "/../stderr", O_WRONLY | O_CREAT | O_TRUNC);
    Stroma::catch_stop_signals();
    const int code = run_words(wanted.at("arguments"));
    std::cout.flush();
    _exit(code);
  }

  double
  seconds_since(const Clock::time_point start)
  {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  json
  watch(const pid_t child, const json &wanted)
  {
    const auto   start   = Clock::now();
    const double seconds = wanted.at("seconds");
    auto         signals = wanted.value("signals", std::vector<std::pair<int, double>>());
    bool         asked = false, asked_again = false, killed = false;
    int          status = 0;
    while (waitpid(child, &status, WNOHANG) == 0)
      {
        const double elapsed = seconds_since(start);
        while (!signals.empty() && elapsed > signals.front().second)
          {
            kill(child, signals.front().first);
            signals.erase(signals.begin());
          }
        if (elapsed > seconds && !asked)
          asked = kill(child, SIGTERM) == 0;
        if (elapsed > seconds + patience && !asked_again)
          asked_again = kill(child, SIGTERM) == 0;
        if (elapsed > seconds + 2 * patience && !killed)
          killed = kill(child, SIGKILL) == 0;
        std::this_thread::sleep_for(std::chrono::microseconds(500));
      }
    return {{"code", WIFEXITED(status) ? WEXITSTATUS(status) : -1},
            {"signal", WIFSIGNALED(status) ? WTERMSIG(status) : 0},
            {"asked", asked},
            {"killed", killed},
            {"elapsed", seconds_since(start)}};
  }
} // namespace

int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  for (std::string line; std::getline(std::cin, line);)
    {
      const auto  wanted = json::parse(line);
      const pid_t child  = fork();
      if (child == 0)
        run_case(wanted);
      std::cout << watch(child, wanted).dump() << std::endl;
    }
  return 0;
}
