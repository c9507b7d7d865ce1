#pragma once

#include <mpi.h>

#include <string>

namespace Stroma::Studies
{
  /// Draws by contrib/plot/@p script the results in @p folder, on rank 0; where python3, numpy or matplotlib are missing
  /// it says the command instead. Never fails. Collective.
  void draw_picture(const std::string &script, const std::string &folder, MPI_Comm comm);
} // namespace Stroma::Studies
