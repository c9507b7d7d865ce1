#include <stroma/base/errors.h>
#include <stroma/output/collective.h>

#include <limits>

namespace Stroma::Output
{
  void
  throw_if_any(const std::string &error, const MPI_Comm comm)
  {
    namespace MPI            = dealii::Utilities::MPI;
    constexpr unsigned none  = std::numeric_limits<unsigned int>::max();
    const unsigned int first = MPI::min(error.empty() ? none : MPI::this_mpi_process(comm), comm);
    if (first != none)
      throw UserError(MPI::broadcast(comm, error, first));
  }
} // namespace Stroma::Output
