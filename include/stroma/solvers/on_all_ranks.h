#pragma once

#include <deal.II/base/mpi.h>

namespace Stroma::Solvers
{
  /// Calls @p set_up and tells, on all ranks alike, whether it threw on none: libraries may throw on one rank only, and they
  /// throw numbers too. Collective.
  template <typename SetUp>
  bool
  on_all_ranks(const SetUp &set_up, const MPI_Comm comm)
  {
    int failed = 0;
    try
      {
        set_up();
      }
    catch (...)
      {
        failed = 1;
      }
    return dealii::Utilities::MPI::max(failed, comm) == 0;
  }
} // namespace Stroma::Solvers
