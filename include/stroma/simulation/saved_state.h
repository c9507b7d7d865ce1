#pragma once

#include <stroma/simulation/method.h>

namespace Stroma
{
  /// Writes the committed state of @p method: its time "time" [s], its scalars, which may come from what the state does not
  /// hold, and what the method itself needs. Collective.
  void save_state(const Method &method, Output::ArchiveWriter &archive, MPI_Comm comm);

  /// Sets @p method up with the state that save_state() wrote, on any number of ranks. Collective.
  void load_state(Method &method, const Output::ArchiveReader &archive, MPI_Comm comm);
} // namespace Stroma
