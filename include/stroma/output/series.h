#pragma once

#include <deal.II/base/mpi.h>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace Stroma::Output
{
  /**
   * Numbers over time as comma-separated values: one row a step, one header of names with units, written through to
   * the disk after each row. The first row fixes the columns. All functions are collective; rank 0's values count.
   */
  class TimeSeries
  {
  public:
    /// (column name with unit, value). The first column is the time: ("time_s", t).
    using Row = std::vector<std::pair<std::string, double>>;

    /// Starts a new file, replacing an old one at the first row.
    TimeSeries(const std::string &path, MPI_Comm comm);

    /// Continues a file: removes rows later than @p until [s] and half-written ones. A missing file is started anew.
    /// Returns whether the row of that time is there. Throws UserError if the file is not a series, OutputError if it
    /// cannot be rewritten.
    bool resume(double until);

    /// Appends a row. Throws UserError if the columns differ from the file's, OutputError if the disk does not take it;
    /// the file then ends with the row before.
    void add(const Row &row);

  private:
    void write(const Row &row);
    bool read_back(double until);

    std::string   path;
    MPI_Comm      comm;
    std::string   header; ///< rank 0 only, empty before the first row
    std::ofstream file;   ///< rank 0 only
  };

  /// Throws UserError if two columns of @p row have one name. Local.
  void check_names(const TimeSeries::Row &row);
} // namespace Stroma::Output
