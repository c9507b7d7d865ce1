#pragma once

#include <deal.II/base/mpi.h>

#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// Numbers that were measured, in SI, by what they were measured against.
  struct Measured
  {
    std::vector<double>       x, y;      ///< x without repetition, from one end to the other
    std::vector<double>       deviation; ///< standard deviation of each y; empty: the same for all, and not known
    std::vector<unsigned int> line;      ///< of the file
  };

  /// What is wanted of a file of measured numbers.
  struct MeasuredColumns
  {
    std::string x, y;      ///< names of results with their unit in SI, as series.csv has them
    std::string deviation; ///< name of the column with standard deviations of y; empty: there is none
  };

  /**
   * Reads comma-separated values with one line of names above them. A column is named as the result that it is compared with, or
   * with a multiple of its unit in the place of it: reaction_force_y_nN for reaction_force_y_N, time_min for time_s; units
   * with "per" have no multiples. Standard deviations are in the unit of y at the end of their column's name, or a multiple of it
   * (sd_nN); without one they are in that of the column of y. Two columns for one name are refused. Empty lines and those that
   * begin with # are passed over. Throws UserError on all ranks: file and line, what is wrong, what to do.
   * Collective.
   */
  Measured read_measured(const std::string &path, const MeasuredColumns &columns, MPI_Comm comm);
} // namespace Stroma::Studies
