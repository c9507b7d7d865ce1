#pragma once

#include <deal.II/base/mpi.h>

#include <cstdint>
#include <iosfwd>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace Stroma::Output
{
  /// What a run was, what it cost and what came out of it, for people (print) and programs (write).
  struct Summary
  {
    std::string status;         ///< "finished", "stopped" or "failed", with the reason after ": "
    std::string ending;         ///< why it ended before its time, if it did
    std::string title;          ///< of the scene
    std::string method;         ///< mpm, nsph, sph or fem
    std::string parameter_file; ///< as given
    std::string version = STROMA_VERSION;
    std::string date; ///< end of the run, ISO 8601; filled in by write() and print() if empty

    unsigned int  dimension = 0;
    unsigned int  n_ranks   = 0;
    std::uint64_t n_points = 0, n_cells = 0, n_dofs = 0;
    std::uint64_t n_steps = 0, newton_iterations = 0, linear_iterations = 0, residual_evaluations = 0;

    double                                      wall_time_s = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::pair<std::string, double>> phases; ///< name and wall time [s], in the order of the run
    std::uint64_t                               peak_memory_bytes = 0; ///< summed over ranks
    double                                      bytes_per_point   = std::numeric_limits<double>::quiet_NaN();

    std::vector<std::string>      used;      ///< parts that this scene uses
    std::vector<std::string>      left_out;  ///< parts that it does not need and that therefore cost nothing
    std::map<std::string, double> results;   ///< name with unit and value; not a number where it has none
    std::vector<std::string>      materials; ///< names; the field "material" numbers them from 0
    std::vector<std::string>      laws;      ///< what the law of each material is, in words and equations

    /// Replaces the JSON file @p path in one go; numbers that are not finite become null, and the results
    /// among them are named in "without_value".
    /// Collective; rank 0's values count. Throws OutputError on all ranks if it cannot be written.
    void write(const std::string &path, MPI_Comm comm) const;

    /// Names of the results that are not finite.
    std::vector<std::string> without_value() const;

    /// The status in a summary's file; "" if there is none. Local.
    static std::string status_in(const std::string &path);

    /// A table for people; nothing for zero counts. Local.
    void print(std::ostream &out) const;
  };
} // namespace Stroma::Output
