#pragma once

#include <stdexcept>
#include <string>

namespace Stroma
{
  /**
   * The file system did not take what the program wrote: full, out of inodes, gone, or not writable any more. The input
   * is good and the state in memory too, so a run keeps it where it can and ends with exit code 2.
   * Throw it on all ranks or on none, as UserError.
   */
  class OutputError : public std::runtime_error
  {
  public:
    OutputError(const std::string &path, const std::string &message)
      : std::runtime_error(path + ": " + message)
    {}

    explicit OutputError(const std::string &message)
      : std::runtime_error(message)
    {}
  };
} // namespace Stroma
