#pragma once

#include <deal.II/base/mpi.h>

#include <string>
#include <utility>
#include <vector>

namespace Stroma::Output
{
  /**
   * The list of (time, file) that lets ParaView play a series of records: a .pvd for VTU records, a temporal collection
   * for XDMF records (chosen by the ending of @p path, .pvd or .xdmf). The file is replaced as a whole after each
   * addition, so it is readable at any moment of a run. All functions are collective; rank 0's arguments count.
   */
  class PvdSeries
  {
  public:
    /// Starts an empty series; nothing is written yet.
    PvdSeries(const std::string &path, MPI_Comm comm);

    /// Takes over the entries of the file @p path up to and including time @p until [s], drops later ones and rewrites
    /// the file. A missing file counts as empty. Throws OutputError if it cannot be written.
    void restore(double until);

    /// The number after the largest one in the names of the list's files: a record of this number replaces none of them.
    unsigned int next_number() const;

    /// Whether there is an entry of time @p time [s].
    bool has(double time) const;

    /// @param time [s]; an entry of the same time is replaced
    /// @param file record, relative to the series' folder
    void add(double time, const std::string &file);

    /// (time [s], file), in the order of addition. Rank 0 only; empty on other ranks.
    const std::vector<std::pair<double, std::string>> &
    entries() const
    {
      return list;
    }

  private:
    std::string text() const;

    std::string                                 path;
    MPI_Comm                                    comm;
    std::vector<std::pair<double, std::string>> list;
  };
} // namespace Stroma::Output
