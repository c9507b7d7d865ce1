#pragma once

#include <stroma/base/errors.h>
#include <stroma/base/text.h>

#include <deal.II/base/mpi.h>

#include <filesystem>
#include <string>

namespace Stroma
{
  /**
   * Runs @p work on rank 0 only, for reading files and the like. If it throws, every rank throws a UserError with
   * the same message, so that nobody waits for the others. Collective.
   */
  template <typename Work>
  void
  on_root(const MPI_Comm comm, const Work &work)
  {
    std::string message;
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      try
        {
          work();
        }
      catch (const std::filesystem::filesystem_error &error)
        {
          message = shown(error.path1().string()) + ": " + error.code().message();
        }
      catch (const std::exception &error)
        {
          message = error.what();
          if (message.empty())
            message = "unknown error";
        }
    message = dealii::Utilities::MPI::broadcast(comm, message, 0);
    if (!message.empty())
      throw UserError(message);
  }
} // namespace Stroma
