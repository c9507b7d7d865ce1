#include <stroma/base/text.h>
#include <stroma/studies/side_by_side.h>

#include <algorithm>

namespace Stroma::Studies
{
  Group::Group(const MPI_Comm whole, const unsigned int n)
    : number(dealii::Utilities::MPI::this_mpi_process(whole) * n / dealii::Utilities::MPI::n_mpi_processes(whole))
  {
    MPI_Comm_split(whole, number, 0, &comm);
  }

  Group::~Group()
  {
    MPI_Comm_free(&comm);
  }

  RunStatus
  worse(const RunStatus a, const RunStatus b)
  {
    const auto rank = [](const RunStatus s) { return s == RunStatus::stopped ? 2 : s == RunStatus::failed ? 1 : 0; };
    return rank(a) > rank(b) ? a : b;
  }

  RunStatus
  worst(RunStatus status, const MPI_Comm comm)
  {
    for (const int of_rank : dealii::Utilities::MPI::all_gather(comm, static_cast<int>(status)))
      status = worse(status, static_cast<RunStatus>(of_rank));
    return status;
  }

  void
  check_groups(const unsigned int at_once, const MPI_Comm comm)
  {
    const unsigned int ranks = dealii::Utilities::MPI::n_mpi_processes(comm);
    if (at_once == 0 || at_once > ranks)
      throw UserError("--at-once " + std::to_string(at_once),
                      "the program runs on " + counted(ranks, "rank") + "; give 1 to " + std::to_string(ranks) +
                        ", or start with mpirun -np " + std::to_string(std::max(at_once, 1u)));
  }
} // namespace Stroma::Studies
