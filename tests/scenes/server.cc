// Runs the program many times in one process on any number of ranks: a start costs .4 s of each rank, most of it loading libraries.
//
// A line of standard input is a case, {"arguments": [...], "output": FILE, "error": FILE}: all ranks run `stroma arguments`, and
// what they print goes to the files. A line of standard output answers with the exit code; 4: an exception that the program did
// not foresee.

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include "../run_words.h"

namespace
{
  using dealii::Utilities::MPI::broadcast;
  using dealii::Utilities::MPI::max;
  using dealii::Utilities::MPI::this_mpi_process;

  /// Sends a stream of this process, standard output (1) or standard error (2), to the end of a file while it lives.
  class Redirected
  {
  public:
    Redirected(const int stream, const std::string &path)
      : stream{stream}
      , kept{dup(stream)}
    {
      const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
      if (file < 0)
        throw std::runtime_error("cannot write " + path);
      dup2(file, stream);
      close(file);
    }

    ~Redirected()
    {
      std::cout.flush();
      std::fflush(nullptr);
      dup2(kept, stream);
      close(kept);
    }

    Redirected(const Redirected &) = delete;

  private:
    int stream;
    int kept;
  };

  int
  run_case(const nlohmann::json &wanted)
  {
    const Redirected output(1, wanted.at("output")), error(2, wanted.at("error"));
    return run_words(wanted.at("arguments"));
  }

  /// Waits for all ranks without using a core, as a broadcast would.
  void
  sleep_until_all_are_here()
  {
    MPI_Request request;
    MPI_Ibarrier(MPI_COMM_WORLD, &request);
    for (int all_here = 0; !all_here; MPI_Test(&request, &all_here, MPI_STATUS_IGNORE))
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }

  /// The next line of standard input of the first rank, on all ranks.
  std::string
  next_line()
  {
    std::string line;
    if (this_mpi_process(MPI_COMM_WORLD) == 0)
      std::getline(std::cin, line);
    sleep_until_all_are_here();
    return broadcast(MPI_COMM_WORLD, line);
  }
} // namespace

int
main(int argc, char **argv)
{
  const dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  for (std::string line = next_line(); !line.empty(); line = next_line())
    {
      const int code = max(run_case(nlohmann::json::parse(line)), MPI_COMM_WORLD);
      if (this_mpi_process(MPI_COMM_WORLD) == 0)
        std::cout << code << std::endl;
    }
}
