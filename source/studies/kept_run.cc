#include <stroma/base/log.h>
#include <stroma/base/output_error.h>
#include <stroma/studies/kept_run.h>

namespace Stroma::Studies
{
  RunStatus
  run_or_keep(const ParameterFile &file, const std::string &path, const KeptRuns &kept, RunRecord &record,
              const MPI_Comm comm)
  {
    const auto parameters = parameters_text(file);
    record                = kept.resume ? RunRecord::read(path, comm) : RunRecord();
    if (record.status.empty() || record.parameters != parameters)
      {
        // What is there is of a run that was interrupted, or had other parameters: replaced once the scene is set up.
        RunOptions options;
        options.output    = path;
        options.overwrite = kept.overwrite || kept.resume;
        const auto result = run_simulation(file, options, comm);
        if (result.status == RunStatus::stopped)
          return RunStatus::stopped;
        if (result.is_of_output)
          throw OutputError(path + ": " + result.summary.status);
        if (result.status == RunStatus::failed)
          Log::warning(path + ": " + result.summary.status);
        record = RunRecord(parameters, result);
        record.write(path, comm);
      }
    else
      Log::line("  has ended: kept");
    return record.finished() ? RunStatus::finished : RunStatus::failed;
  }
} // namespace Stroma::Studies
