#pragma once

#include <stdexcept>
#include <string>

namespace Stroma
{
  /**
   * What the user gave cannot be used. The message is one line: where it was given, what was given, what is allowed
   * and what to do. The program prints it once, on rank 0, and ends with exit code 1.
   * Throw it on all ranks or on none: a throw on one rank deadlocks the others.
   */
  class UserError : public std::runtime_error
  {
  public:
    /// @param where place of the input ("scene.prm:12", "--set Grid/Cells"), or empty
    UserError(const std::string &where, const std::string &message)
      : std::runtime_error(where.empty() ? message : where + ": " + message)
    {}

    explicit UserError(const std::string &message)
      : std::runtime_error(message)
    {}
  };
} // namespace Stroma
