#include <stroma/base/constants_in_use.h>
#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/signals.h>
#include <stroma/base/text.h>
#include <stroma/output/folder.h>
#include <stroma/studies/kept_run.h>
#include <stroma/studies/means.h>
#include <stroma/studies/missing_results.h>
#include <stroma/studies/picture.h>
#include <stroma/studies/side_by_side.h>
#include <stroma/studies/study_table.h>
#include <stroma/studies/sweep.h>

#include <algorithm>
#include <filesystem>

namespace Stroma::Studies
{
  namespace
  {
    namespace fs = std::filesystem;

    RunOptions
    into(const std::string &folder, const bool overwrite)
    {
      RunOptions options;
      options.output    = folder;
      options.overwrite = overwrite;
      return options;
    }

    /// The parameter file of a run.
    ParameterFile
    file_of(const ParameterFile &scene, const StudyPlan &plan, const std::vector<std::string> &set)
    {
      ParameterFile one = scene;
      for (const auto &assignment : set)
        one.set(assignment);
      if (plan.error.wanted)
        one.set("Output/Keep states=true");
      return one;
    }

    /// The runs of a study by one group of ranks.
    class Runner
    {
    public:
      Runner(const ParameterFile &scene, const StudyPlan &plan, const StudyOptions &options, const std::string &folder,
             const MPI_Comm comm)
        : scene(scene)
        , plan(plan)
        , options(options)
        , folder(folder)
        , comm(comm)
      {}

      /// Does what is still to be done for a run; leaves its record. @p timed short runs are repeated
      RunStatus
      execute(const std::vector<std::string> &set, const std::string &name, const bool timed)
      {
        const auto one  = file_of(scene, plan, set);
        const auto path = folder + "/" + name;
        RunRecord  record;
        if (const auto status = run_or_keep(one, path, {options.overwrite, options.resume}, record, comm);
            status != RunStatus::finished)
          return status;
        if (timed)
          if (const auto status = repeat(one, path, record); status != RunStatus::finished)
            return status;
        if (timed && plan.error.wanted)
          if (const std::string key = error_key(); record.error_key != key)
            find_errors(path, key, record);
        return RunStatus::finished;
      }

    private:
      /// A short run again until there are enough times of it. Rank 0's times count.
      RunStatus
      repeat(const ParameterFile &one, const std::string &path, RunRecord &record) const
      {
        const double first = dealii::Utilities::MPI::broadcast(comm, record.wall_times[0], 0);
        while (first < plan.repeat_below && record.wall_times.size() < plan.repeat)
          {
            Log::line("  again, for its time");
            const auto result = run_simulation(one, into(path + "/again", true), comm);
            on_root(comm, [&] { Output::remove_run(path + "/again"); });
            if (result.is_of_output)
              throw OutputError(path + "/again: " + result.summary.status);
            if (result.status != RunStatus::finished)
              return result.status;
            record.wall_times.push_back(result.summary.wall_time_s);
            record.cpu_times.push_back(result.cpu_time_s);
            record.write(path, comm);
          }
        return RunStatus::finished;
      }

      /// What the errors of the present study are found with; a run or reference elsewhere may have changed meanwhile.
      std::string
      error_key() const
      {
        std::string key = plan.error.key;
        on_root(comm, [&] {
          std::error_code code;
          for (const std::string name : {"", "/parameters.prm", "/summary.json"})
            if (const auto time = fs::last_write_time(plan.error.against + name, code); !code)
              key += std::to_string(time.time_since_epoch().count()) + "\n";
        });
        return dealii::Utilities::MPI::broadcast(comm, key, 0);
      }

      void
      find_errors(const std::string &path, const std::string &key, RunRecord &record) const
      {
        RunSource  run(path, comm);
        const auto against = plan.error.against == "reference" ? folder + "/reference" : plan.error.against;
        const auto source  = open_source(against, run, comm);
        record.errors.clear();
        for (const auto &field : compare(run, *source, plan.error.compare).fields)
          {
            const auto &norms          = field.regions.front();
            record.errors[field.field] = {{norms.l2.relative(), norms.h1.relative(), norms.max.relative()}};
          }
        record.error_key = key;
        record.write(path, comm);
      }

      const ParameterFile &scene;
      const StudyPlan     &plan;
      const StudyOptions  &options;
      const std::string   &folder;
      MPI_Comm             comm;
    };

    /// Folders of all runs below the study's.
    std::vector<std::string>
    folders_of(const StudyPlan &plan)
    {
      std::vector<std::string> folders;
      for (const auto &run : plan.runs)
        folders.push_back(run.folder);
      if (plan.error.against == "reference")
        folders.push_back("reference");
      return folders;
    }

    /// Runs of an earlier study are not written over unasked.
    void
    check_unused(const StudyPlan &plan, const std::string &folder)
    {
      for (const auto &name : folders_of(plan))
        if (Output::holds_results(folder + "/" + name))
          throw UserError("--output " + folder,
                          "the folder holds results of a study (" + name +
                            "); choose another folder, or --resume to continue, or --overwrite to replace");
    }

    /// Removes what an earlier study knows of these runs.
    void
    forget_records(const StudyPlan &plan, const std::string &folder)
    {
      std::error_code ignored;
      for (const auto &name : folders_of(plan))
        fs::remove(folder + "/" + name + "/" + RunRecord::file_name, ignored);
    }

    /// Reads the scene with every case and with every value once, before the first one runs; @p set_up makes its grid too.
    void
    check_scenes(const ParameterFile &scene, const StudyPlan &plan, const bool set_up, const MPI_Comm comm)
    {
      RunOptions only_check;
      only_check.check = true;
      const auto check = [&](const std::vector<std::string> &set, const std::string &where) {
        try
          {
            const auto one = with_assignments(scene, set);
            if (set_up)
              run_simulation(one, only_check, comm);
            else
              read_only(one, comm);
          }
        catch (const UserError &error)
          {
            // What the study sets has no place of its own in the file.
            for (const auto &assignment : set)
              if (std::string(error.what()).rfind("--set " + assignment + ":", 0) == 0)
                throw UserError(where, error.what());
            throw;
          }
      };
      const auto check_first = [&](const auto &is_wanted, const std::string &where) {
        const auto run = std::find_if(plan.runs.begin(), plan.runs.end(), is_wanted);
        if (run != plan.runs.end())
          check(run->set, where);
      };
      for (unsigned int c = 0; c < plan.cases.size(); ++c)
        check_first([&](const PlannedRun &run) { return run.in_case == c; }, plan.cases[c].where);
      for (unsigned int v = 0; v < plan.varied.size(); ++v)
        for (const auto &value : plan.varied[v].values)
          check_first([&](const PlannedRun &run) { return run.values[v] == value; }, plan.varied[v].where);
      if (plan.error.against == "reference")
        check(plan.error.reference, plan.error.where_reference);
    }

    /// The records of all runs that have ended with the present parameters, on the rank that calls; errors only if they are
    /// those of the present sections Error and Reference.
    std::vector<RunRecord>
    records_of(const ParameterFile &scene, const StudyPlan &plan, const std::string &folder)
    {
      std::vector<RunRecord> records;
      for (const auto &run : plan.runs)
        {
          RunRecord record = RunRecord::read(folder + "/" + run.folder);
          if (record.parameters != parameters_text(file_of(scene, plan, run.set)))
            record = RunRecord();
          if (record.error_key.rfind(plan.error.key, 0) != 0)
            record.errors.clear();
          records.push_back(record);
        }
      return records;
    }

    /// All runs, in groups of ranks side by side, as long as `Results` may be had.
    RunStatus
    execute_all(const ParameterFile &scene, const StudyPlan &plan, const StudyOptions &options,
                const std::string &folder, const MPI_Comm comm)
    {
      return side_by_side(plan.runs.size(), options.at_once, comm, [&](const std::size_t i, const Group &group) {
        Log::line("Run " + std::to_string(i + 1) + " of " + std::to_string(plan.runs.size()) + ": " +
                  plan.runs[i].folder);
        auto status = Runner(scene, plan, options, folder, group.comm)
                        .execute(plan.runs[i].set, plan.runs[i].folder, true);
        bool misses_a_result = false;
        on_root(group.comm, [&] {
          const auto records = records_of(scene, plan, folder);
          misses_a_result    = !missing_result(plan, records).empty();
          if (group.number == 0)
            write_study(plan, records, folder, options.at_once);
        });
        if (dealii::Utilities::MPI::broadcast(group.comm, misses_a_result, 0) || stop_requested(group.comm))
          status = RunStatus::stopped;
        return status;
      });
    }
  } // namespace

  std::size_t
  check_study(const ParameterFile &file, const MPI_Comm comm)
  {
    const StudyPlan plan = read_plan(file, comm);
    check_scenes(file.without("Study"), plan, false, comm);
    return plan.runs.size();
  }

  RunStatus
  run_study(const ParameterFile &file, const StudyOptions &options, const MPI_Comm comm)
  {
    const StudyPlan     plan  = read_plan(file, comm);
    const ParameterFile scene = file.without("Study");
    check_groups(options.at_once, comm);
    if (options.at_once > 1)
      Log::line("Runs share the machine, " + std::to_string(options.at_once) +
                " at once: their times cannot be compared with those of runs one after another");
    Output::RunFolder folder({options.output, file.path(), options.overwrite, options.resume}, comm);
    if (!options.overwrite && !options.resume)
      on_root(comm, [&] { check_unused(plan, folder.path()); });
    check_scenes(scene, plan, options.overwrite, comm);
    folder.open();
    if (options.overwrite)
      on_root(comm, [&] { forget_records(plan, folder.path()); });

    RunStatus status = RunStatus::finished;
    if (plan.error.against == "reference")
      {
        Log::line("Reference run");
        status = Runner(scene, plan, options, folder.path(), comm).execute(plan.error.reference, "reference", false);
        if (status == RunStatus::failed)
          Log::warning("the reference run failed, so no other run was done");
      }
    if (status == RunStatus::finished)
      {
        status = execute_all(scene, plan, options, folder.path(), comm);
        on_root(comm, [&] {
          const auto records = records_of(scene, plan, folder.path());
          write_study(plan, records, folder.path(), options.at_once);
          Log::line("\n" + aligned(study_rows(plan, records)));
          if (plan.averaged >= 0)
            Log::line("\n" + aligned(mean_rows(plan, means_of(plan, records))));
          const auto failed = std::count_if(records.begin(), records.end(), [](const RunRecord &record) {
            return !record.status.empty() && !record.finished();
          });
          if (failed > 0)
            Log::warning(std::to_string(failed) + " of " + counted(records.size(), "run") +
                         " failed; they have no results in the table");
        });
        draw_picture("plot_study.py", folder.path(), comm);
        on_root(comm, [&] { check_results(plan, records_of(scene, plan, folder.path())); });
      }
    Log::line("Results in " + folder.path());
    return status;
  }
} // namespace Stroma::Studies
