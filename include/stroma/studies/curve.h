#pragma once

#include <deal.II/base/mpi.h>

#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// Two columns of the series of a run.
  struct Curve
  {
    std::vector<double> x, y;          ///< x grows
    bool                falls = false; ///< x fell in the run: its first row is the last here

    struct Value
    {
      double y;       ///< by monotone cubics between the steps (Fritsch & Butland 1984)
      double by_line; ///< by straight lines: the difference says how well steps resolve the curve
    };

    /// At @p at, which lies between the ends.
    Value value(double at) const;

    /// Whether @p at lies between the ends, up to a millionth of the range.
    bool reaches(double at) const;

    /// Whether @p at lies before the first row of the run.
    bool is_before_run(double at) const;

    /// Whether @p at lies between two rows of a curve that has too few for cubics.
    bool is_only_line(double at) const;
  };

  /// Says that data against @p name at @p at, which the curve does not reach, cannot be compared, and what to do.
  std::string beyond_run(const Curve &curve, const std::string &name, double at);

  /**
   * Reads columns @p x and @p y of series.csv in @p folder; rows without a number in one of them are passed over. Where x only
   * falls both are turned round. Throws UserError, beginning with @p where, on all ranks if a column is not there or x goes back
   * and forth. Collective.
   */
  Curve read_curve(const std::string &folder, const std::string &x, const std::string &y, const std::string &where,
                   MPI_Comm comm);
} // namespace Stroma::Studies
