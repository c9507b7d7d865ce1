#pragma once

#include <stroma/output/collective.h>
#include <stroma/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <string>

namespace Stroma::Studies
{
  /// A part of the ranks, which takes every n-th run.
  class Group
  {
  public:
    Group(MPI_Comm whole, unsigned int n);
    ~Group();
    Group(const Group &)            = delete;
    Group &operator=(const Group &) = delete;

    unsigned int number;
    MPI_Comm     comm;
  };

  /// The one that says more of several runs: stopped before failed before finished.
  RunStatus worse(RunStatus a, RunStatus b);

  /// The worst of all ranks. Collective.
  RunStatus worst(RunStatus status, MPI_Comm comm);

  /// Throws UserError unless @p at_once groups of ranks can be made.
  void check_groups(unsigned int at_once, MPI_Comm comm);

  /**
   * Calls work(i, group) for i = 0 .. n - 1, in @p at_once groups of ranks side by side; what they return is joined. After one
   * that was stopped its group takes no other. Errors of one group wait until the others are done, and are then thrown on all
   * ranks. Collective.
   */
  template <typename Work>
  RunStatus
  side_by_side(const std::size_t n, const unsigned int at_once, const MPI_Comm comm, const Work &work)
  {
    const Group group(comm, at_once);
    RunStatus   status = RunStatus::finished;
    std::string error, output_error;
    try
      {
        for (std::size_t i = group.number; i < n && status != RunStatus::stopped; i += at_once)
          status = worse(status, work(i, group));
      }
    catch (const UserError &problem)
      {
        error = problem.what();
      }
    catch (const OutputError &problem)
      {
        output_error = problem.what();
      }
    Output::throw_if_any(error, comm);
    Output::throw_if_any<OutputError>(output_error, comm);
    return worst(status, comm);
  }
} // namespace Stroma::Studies
