#pragma once

#include <stroma/base/parameter_file.h>
#include <stroma/simulation/simulation.h>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// What a study knows of a run that has ended. It lies in the run's folder, so that an interrupted study goes on.
  struct RunRecord
  {
    std::string                                  parameters; ///< as parameters_text() gives them
    std::string                                  status;     ///< of the summary; empty: the run has not ended
    std::map<std::string, double>                results;
    std::uint64_t                                n_steps = 0, newton_iterations = 0, linear_iterations = 0;
    std::vector<double>                          wall_times;            ///< of the run and its repetitions [s]
    std::vector<double>                          cpu_times;             ///< the same, summed over ranks
    std::uint64_t                                peak_memory_bytes = 0; ///< summed over ranks; 0: not known
    std::string                                  error_key;             ///< ErrorPlan::key of the errors
    std::map<std::string, std::array<double, 3>> errors;                ///< of each field: relative L2, H1, max

    RunRecord() = default;
    RunRecord(const std::string &parameters, const RunResult &result);

    bool
    finished() const
    {
      return status == "finished";
    }

    /// Replaces the record of a folder in one go. Collective; throws UserError on all ranks.
    void write(const std::string &folder, MPI_Comm comm) const;

    /// The record of a folder; empty status if there is none that can be read. Local to the rank.
    static RunRecord read(const std::string &folder);

    /// The same on all ranks, as rank 0 sees it. Collective.
    static RunRecord read(const std::string &folder, MPI_Comm comm);

    /// Name of the file in a run's folder.
    static constexpr const char *file_name = "study_run.json";
  };

  /// All entries of a parameter file, one a line, in order, and the program's version: runs with the same text are equal.
  std::string parameters_text(const ParameterFile &file);
} // namespace Stroma::Studies
