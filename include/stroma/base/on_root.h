#pragma once

#include <stroma/base/errors.h>
#include <stroma/base/output_error.h>
#include <stroma/base/text.h>

#include <deal.II/base/mpi.h>

#include <filesystem>
#include <string>

namespace Stroma
{
  /**
   * Runs @p work on rank 0 only, for reading files and the like. If it throws, every rank throws an error with the same
   * message, so that nobody waits for the others: an OutputError if it was one, otherwise a UserError. Collective.
   */
  template <typename Work>
  void
  on_root(const MPI_Comm comm, const Work &work)
  {
    std::string message;
    bool        is_of_output = false;
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
          message      = error.what();
          is_of_output = dynamic_cast<const OutputError *>(&error) != nullptr;
          if (message.empty())
            message = "unknown error";
        }
    message = dealii::Utilities::MPI::broadcast(comm, message, 0);
    if (message.empty())
      return;
    if (dealii::Utilities::MPI::broadcast(comm, is_of_output, 0))
      throw OutputError(message);
    throw UserError(message);
  }
} // namespace Stroma
