#pragma once

#include <deal.II/base/mpi.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

/// A folder shared by all ranks, removed at the end of the test. Collective.
class TemporaryFolder
{
public:
  TemporaryFolder()
  {
    namespace MPI      = dealii::Utilities::MPI;
    static int counter = 0;
    const auto base    = std::filesystem::temp_directory_path() / "stroma_test_output_";
    path = MPI::broadcast(MPI_COMM_WORLD, base.string() + std::to_string(getpid()) + "_" + std::to_string(counter++),
                          0);
    if (is_first())
      std::filesystem::create_directories(path);
    MPI_Barrier(MPI_COMM_WORLD);
  }

  ~TemporaryFolder()
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (is_first())
      std::filesystem::remove_all(path);
  }

  std::string
  operator/(const std::string &name) const
  {
    return path + "/" + name;
  }

  static bool
  is_first()
  {
    return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  }

  std::string path;
};

inline std::string
read_text(const std::string &path)
{
  std::ifstream      in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Writes a file on rank 0; all ranks then see it.
inline void
put_text(const std::string &path, const std::string &text)
{
  if (TemporaryFolder::is_first())
    std::ofstream(path, std::ios::binary) << text;
  MPI_Barrier(MPI_COMM_WORLD);
}

/// What a call throws, or "".
template <typename Error, typename Call>
std::string
message_of(const Call &call)
{
  try
    {
      call();
    }
  catch (const Error &error)
    {
      return error.what();
    }
  return "";
}
