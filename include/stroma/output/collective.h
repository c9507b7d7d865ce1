#pragma once

#include <stroma/base/on_root.h>

#include <string>

namespace Stroma::Output
{
  /// Throws UserError with the message of the lowest rank whose @p error is not empty, on all ranks; returns if all
  /// are empty. Collective.
  void throw_if_any(const std::string &error, MPI_Comm comm);
} // namespace Stroma::Output
