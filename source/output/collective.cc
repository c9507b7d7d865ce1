#include <stroma/output/collective.h>

#include <limits>

namespace Stroma::Output
{
  std::string
  first_error(const std::string &error, const MPI_Comm comm)
  {
    namespace MPI            = dealii::Utilities::MPI;
    constexpr unsigned none  = std::numeric_limits<unsigned int>::max();
    const unsigned int first = MPI::min(error.empty() ? none : MPI::this_mpi_process(comm), comm);
    return first == none ? "" : MPI::broadcast(comm, error, first);
  }
} // namespace Stroma::Output
