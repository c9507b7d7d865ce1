// Runs the program many times in one process on any number of ranks: a start costs .7 s, most of it loading libraries.
//
// A line of standard input is a case, {"arguments": [...], "said": FILE}: all ranks run `stroma arguments`, and what they print
// goes to FILE. A line of standard output answers with the exit code; 4: an exception that the program did not foresee.

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "../run_words.h"

namespace
{
  /// Sends standard output and standard error to the end of a file while it lives.
  class Redirected
  {
  public:
    explicit Redirected(const std::string &path)
      : kept{dup(1), dup(2)}
    {
      const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
      if (file < 0)
        throw std::runtime_error("cannot write " + path);
      dup2(file, 1);
      dup2(file, 2);
      close(file);
    }

    ~Redirected()
    {
      std::cout.flush();
      std::fflush(nullptr);
      for (const int stream : {1, 2})
        {
          dup2(kept[stream - 1], stream);
          close(kept[stream - 1]);
        }
    }

    Redirected(const Redirected &) = delete;

  private:
    int kept[2];
  };

  int
  run_case(const nlohmann::json &wanted)
  {
    const Redirected to_file(wanted.at("said"));
    return run_words(wanted.at("arguments"));
  }
} // namespace

int
main(int argc, char **argv)
{
  namespace MPI = dealii::Utilities::MPI;
  MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool            is_root = MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  while (true)
    {
      std::string line;
      if (is_root)
        std::getline(std::cin, line);
      line = MPI::broadcast(MPI_COMM_WORLD, line);
      if (line.empty())
        return 0;
      const int code = MPI::max(run_case(nlohmann::json::parse(line)), MPI_COMM_WORLD);
      if (is_root)
        std::cout << code << std::endl;
    }
}
