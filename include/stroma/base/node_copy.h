#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace Stroma
{
  /**
   * @p bytes of rank 0 for all ranks to read: one copy a node, in memory that its ranks share, or one a rank where a node has
   * no room for such memory. It goes with the last rank that lets go of it, and letting go is local: a rank that fails
   * alone waits for nobody, as it would in MPI_Win_free(). Collective.
   */
  std::shared_ptr<const std::uint8_t> one_copy_a_node(std::vector<std::uint8_t> bytes, MPI_Comm comm);
} // namespace Stroma
