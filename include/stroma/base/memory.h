#pragma once

#include <mpi.h>

#include <string>

/// What a run will need is estimated before it is made, so that a size that was mistyped costs a line and not the machine.
namespace Stroma::Memory
{
  /// Bytes of the linear systems, measured (two to eight times the unknowns at each step of size, one rank, with multigrid):
  /// of a cell of a mesh, and of an entry of the sparse matrix with its share of the preconditioner.
  constexpr double per_cell = 2000., per_nonzero = 25.;

  /// Entry 'Memory limit' [bytes]; 0: what the machine has.
  void set_limit(double bytes);

  /// What this process may take besides what it has [bytes]: the least of what is free in the machine and in its control
  /// group, and what the limit on the process' address space leaves.
  double available();

  /// Whether the ranks of @p comm have @p bytes together, spread evenly. Collective; the same on all of them.
  bool has_room(MPI_Comm comm, double bytes);

  /// Whether the ranks of @p comm have @p bytes together, spread evenly, beside all that they hold now. Collective; the same on
  /// all of them.
  bool has_room_now(MPI_Comm comm, double bytes);

  /**
   * Throws UserError on all ranks if @p bytes, spread evenly over the ranks of @p comm, are more than they have. Collective.
   * @param where place of the entry that makes the size
   * @param what  for example "a grid of 1,000,000,000 cells"
   */
  void require(MPI_Comm comm, double bytes, const std::string &where, const std::string &what);

  /// The same for what this process makes alone.
  void require_here(double bytes, const std::string &where, const std::string &what);

  /// An estimate for people, two digits.
  std::string about(double n);

  /// Throws UserError if @p n unknowns are more than indices of 32 bits can number.
  void require_indices(double n, const std::string &where, const std::string &what);
} // namespace Stroma::Memory
