#pragma once

#include <stroma/base/on_root.h>

#include <deal.II/base/mpi.h>

#include <string>
#include <vector>

namespace Stroma::Output
{
  /// The message of the lowest rank whose @p error is not empty, or "", the same on all ranks. Collective.
  std::string first_error(const std::string &error, MPI_Comm comm);

  /// Throws an error with first_error() on all ranks; returns if all are empty. Collective.
  template <typename Error = UserError>
  void
  throw_if_any(const std::string &error, const MPI_Comm comm)
  {
    const std::string first = first_error(error, comm);
    if (!first.empty())
      throw Error(first);
  }

  /// All ranks' parts, one after the other, on all ranks. Collective.
  template <typename T>
  std::vector<T>
  gather_all(const std::vector<T> &part, const MPI_Comm comm)
  {
    std::vector<T> whole;
    for (const auto &p : dealii::Utilities::MPI::all_gather(comm, part))
      whole.insert(whole.end(), p.begin(), p.end());
    return whole;
  }
} // namespace Stroma::Output
