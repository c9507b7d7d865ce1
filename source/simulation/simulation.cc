#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/signals.h>
#include <stroma/base/text.h>
#include <stroma/output/checkpoints.h>
#include <stroma/output/folder.h>
#include <stroma/output/text_file.h>
#include <stroma/scene/doubts.h>
#include <stroma/scene/image_report.h>
#include <stroma/simulation/run_files.h>
#include <stroma/simulation/run_summary.h>
#include <stroma/simulation/same_scene.h>
#include <stroma/simulation/saved_run.h>
#include <stroma/simulation/saved_state.h>
#include <stroma/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <optional>

namespace Stroma
{
  namespace
  {
    /// Whether the summary in a folder is that of a run that finished.
    bool
    has_finished(const std::string &folder, const MPI_Comm comm)
    {
      bool finished = false;
      on_root(comm, [&] { finished = Output::Summary::status_in(folder + "/summary.json") == "finished"; });
      return dealii::Utilities::MPI::broadcast(comm, finished, 0);
    }

    /// One run from reading to the last file.
    template <int dim>
    class Simulation
    {
    public:
      Simulation(const ParameterFile &file, const RunOptions &options, Parameters::Mode mode, MPI_Comm comm);

      RunResult run();
      std::string
      document() const
      {
        return parameters.print(true);
      }

    private:
      void                     set_up(const Output::ArchiveReader *archive);
      std::string              checkpoint_to_resume() const;
      void                     resume(const Output::ArchiveReader &archive);
      void                     describe_start();
      RunResult                nothing_to_do();
      RunResult                finish(RunStatus status);
      void                     fail_to_write(const OutputError &error, RunStatus &status);
      RunStatus                step_to_end();
      std::optional<RunStatus> take_step();
      void                     after_step(const StepWork &work);
      void                     complete_summary(RunStatus status);

      const ParameterFile                  &file;
      const RunOptions                     &options;
      MPI_Comm                              comm;
      const ResourceUse                     use;
      Timers                                timers;
      Problem<dim>                          problem;
      const Parameters                     &parameters;
      const std::unique_ptr<Scene<dim>>    &scene;
      const Solvers::StepSettings          &step_settings;
      const OutputSettings                 &output;
      const std::unique_ptr<Method>        &method;
      std::unique_ptr<Output::RunFolder>    folder;
      std::unique_ptr<Solvers::StepControl> control;
      std::unique_ptr<RunFiles<dim>>        files;

      double          start_time = 0.;
      RunState        so_far;
      std::string     failure;
      bool            is_of_output = false; ///< the failure
      Output::Summary summary;
    };

    template <int dim>
    Simulation<dim>::Simulation(const ParameterFile &file, const RunOptions &options, const Parameters::Mode mode,
                                const MPI_Comm comm)
      : file(file)
      , options(options)
      , comm(comm)
      , problem(file, mode, comm, timers)
      , parameters(problem.parameters)
      , scene(problem.scene)
      , step_settings(problem.step_settings)
      , output(problem.output)
      , method(problem.method)
    {}

    /// Nothing is removed or written before the scene is known to be usable.
    template <int dim>
    RunResult
    Simulation<dim>::run()
    {
      if (options.check)
        {
          set_up(nullptr);
          method->describe(summary);
          return {RunStatus::checked, summary, ""};
        }
      folder = std::make_unique<Output::RunFolder>(Output::FolderRequest{options.output, file.path(), options.overwrite,
                                                                         options.resume},
                                                   comm);
      Log::line("Stroma " STROMA_VERSION ", " + counted(dealii::Utilities::MPI::n_mpi_processes(comm), "rank") + ": " +
                (scene->title.empty() ? file.path() : scene->title));
      auto must_hit = method->facts.times_to_meet;
      must_hit.insert(must_hit.end(), output.fields_at.begin(), output.fields_at.end());
      control = std::make_unique<Solvers::StepControl>(step_settings, must_hit);

      std::unique_ptr<Output::ArchiveReader> archive;
      if (options.resume)
        {
          const std::string checkpoint = checkpoint_to_resume();
          archive                      = std::make_unique<Output::ArchiveReader>(checkpoint, comm);
          check_same_scene(*archive, checkpoint, parameters, file, file_checksums(*scene),
                           "resume with what it was, or start anew with --overwrite");
        }
      set_up(archive.get());

      const StopPolitely polite(comm);
      folder->open();
      files = std::make_unique<RunFiles<dim>>(folder->path(), file, problem, *control, so_far, timers, comm);
      if (archive && (method->time >= step_settings.end_time || !method->ending.empty()) &&
          has_finished(folder->path(), comm))
        return nothing_to_do();
      on_root(comm, [&] { Output::write_atomically(folder->file("parameters.prm"), parameters.print(true)); });
      if (archive)
        resume(*archive);
      else
        files->write_row();
      describe_start();
      return finish(step_to_end());
    }

    template <int dim>
    std::string
    Simulation<dim>::checkpoint_to_resume() const
    {
      const std::string checkpoint = Output::Checkpoints(folder->path(), comm).latest();
      if (checkpoint.empty())
        throw UserError("--resume",
                        "folder '" + folder->path() + "' holds no complete checkpoint" +
                          (has_finished(folder->path(), comm) ? ", and its run has finished; nothing is left to do" :
                                                                "; run without --resume, or with --overwrite"));
      return checkpoint;
    }

    template <int dim>
    void
    Simulation<dim>::describe_start()
    {
      method->describe(summary);
      Log::line("  " +
                (summary.n_points > 0 ?
                   counted(summary.n_points, "point") + " of " + brief(summary.bytes_per_point) + " bytes, " :
                   "") +
                counted(summary.n_cells, "cell") + ", " + counted(summary.n_dofs, "unknown"));
      for (const auto &law : summary.laws)
        Log::line("  " + law);
    }

    /// Resumed after its end: everything stays as it is.
    template <int dim>
    RunResult
    Simulation<dim>::nothing_to_do()
    {
      Log::line("  the run in " + folder->path() + " has finished and stays as it is; a later Time/End continues it");
      method->describe(summary);
      for (const auto &[name, value] : method->scalars)
        summary.results[name] = value;
      summary.status  = "finished";
      summary.title   = scene->title;
      summary.n_ranks = dealii::Utilities::MPI::n_mpi_processes(comm);
      return {RunStatus::finished, summary, folder->path()};
    }

    /// The start of a run, which must be finite and have a name for each number.
    template <int dim>
    void
    Simulation<dim>::set_up(const Output::ArchiveReader *archive)
    {
      for (const auto &line : report_images(*scene).lines)
        Log::line("  " + line);
      for (const auto &doubt : doubts(*scene))
        Log::warning(doubt);
      forget_not_finite();
      if (archive)
        load_state(*method, *archive, comm);
      else
        method->setup(nullptr);
      if (const auto message = first_not_finite(comm); !message.empty())
        throw UserError(message);
      Output::check_names(series_row(problem, so_far));
    }

    template <int dim>
    RunResult
    Simulation<dim>::finish(RunStatus status)
    {
      std::string not_saved = status == RunStatus::finished ? "" : files->save_checkpoint();
      try
        {
          files->write_fields();
        }
      catch (const OutputError &error)
        {
          fail_to_write(error, status);
          not_saved = files->save_checkpoint();
        }
      if (!not_saved.empty())
        {
          is_of_output = is_of_output || status != RunStatus::failed;
          failure      = (status == RunStatus::failed ? failure : "asked to stop") +
                    "; no checkpoint could be saved: " + not_saved;
          status = RunStatus::failed;
        }
      try
        {
          complete_summary(status);
        }
      catch (const OutputError &error)
        {
          fail_to_write(error, status);
          summary.status = "failed: " + failure;
        }
      return {status,
              summary,
              folder->path(),
              is_of_output,
              files->has_checkpoint(),
              dealii::Utilities::MPI::sum(use.cpu_time(), comm)};
    }

    /// The first failure is the one to be told.
    template <int dim>
    void
    Simulation<dim>::fail_to_write(const OutputError &error, RunStatus &status)
    {
      if (status != RunStatus::failed)
        {
          failure      = error.what();
          is_of_output = true;
        }
      status = RunStatus::failed;
    }

    template <int dim>
    void
    Simulation<dim>::resume(const Output::ArchiveReader &archive)
    {
      start_time = method->time;
      so_far.load(archive);
      control->load(so_far.step_control);
      files->resume();
      Log::line("  continues at t = " + brief(start_time) + " s after " + counted(so_far.steps, "step"));
    }

    template <int dim>
    RunStatus
    Simulation<dim>::step_to_end()
    {
      try
        {
          if (!options.resume)
            files->write_fields_if_due();
          while (method->time < step_settings.end_time && method->ending.empty())
            {
              if (stop_requested(comm))
                return RunStatus::stopped;
              if (const auto ending = take_step())
                return *ending;
            }
          if (!method->ending.empty())
            Log::line("  the run ends at t = " + brief(method->time) + " s: " + method->ending);
          return RunStatus::finished;
        }
      catch (const OutputError &error)
        {
          RunStatus status = RunStatus::stopped;
          fail_to_write(error, status);
          return status;
        }
    }

    /// Returns how the run ends if the step was not taken; step control is then as before it, for who resumes.
    template <int dim>
    std::optional<RunStatus>
    Simulation<dim>::take_step()
    {
      const auto            control_before = control->save();
      std::vector<StepWork> with_cut;
      while (true)
        {
          const double     time = method->time, next = control->next(time);
          StepWork         work;
          const StepStatus status = method->advance(time, next, work);
          with_cut.push_back(work);
          const std::string not_finite = first_not_finite(comm);
          if (status == StepStatus::ok)
            {
              for (const auto &one : with_cut)
                so_far.add(one);
              control->accept(work.hardest_solve, work.longest_next);
              ++so_far.steps;
              after_step(work);
              failure = not_finite;
              return not_finite.empty() ? std::nullopt : std::optional(RunStatus::failed);
            }
          failure = std::string(to_string(status)) + " in the step from t = " + brief(time) + " to " + brief(next) +
                    " s";
          if (!not_finite.empty())
            failure = not_finite;
          if (status == StepStatus::linear_failed)
            failure += "; a part of the bodies may be held by next to nothing";
          Log::line("  step cut: " + failure);
          const bool is_to_stop  = stop_requested(comm);
          const bool is_hopeless = !not_finite.empty() || !may_be_cut(status);
          if (is_to_stop || is_hopeless || !control->reject())
            {
              control->load(control_before);
              return is_to_stop ? RunStatus::stopped : RunStatus::failed;
            }
        }
    }

    template <int dim>
    void
    Simulation<dim>::after_step(const StepWork &work)
    {
      files->write_row();
      Log::line(so_far.progress(work, start_time, method->time, step_settings.end_time, timers.total()));
      files->write_fields_if_due();
      if (output.checkpoint_every > 0 && so_far.steps % output.checkpoint_every == 0)
        if (const std::string reason = files->save_checkpoint(); !reason.empty())
          Log::warning("no checkpoint at t = " + brief(method->time) + " s: " + reason +
                       "; earlier checkpoints stay usable");
    }

    template <int dim>
    void
    Simulation<dim>::complete_summary(const RunStatus status)
    {
      const auto histograms = complete(summary, problem, so_far, file, files->of_points(), timers, use, comm);
      summary.status        = status == RunStatus::finished ? "finished" :
                              status == RunStatus::stopped  ? "stopped: asked to stop; continue with --resume" :
                                                              "failed: " + failure;
      if (const auto names = summary.without_value(); !names.empty())
        Log::warning("these results are no finite numbers: " + join(names, ", "));
      if (!histograms.empty())
        on_root(comm,
                [&] { Output::write_atomically(folder->file("histograms.csv"), Output::histogram_table(histograms)); });
      summary.write(folder->file("summary.json"), comm);
    }

    template <int dim>
    RunResult
    run_in(const ParameterFile &file, const RunOptions &options, const MPI_Comm comm)
    {
      return Simulation<dim>(file, options, Parameters::Mode::read, comm).run();
    }
  } // namespace

  RunResult
  run_simulation(const ParameterFile &file, const RunOptions &options, const MPI_Comm comm)
  {
    return dimension_of(file) == 2 ? run_in<2>(file, options, comm) : run_in<3>(file, options, comm);
  }

  void
  read_only(const ParameterFile &file, const MPI_Comm comm)
  {
    const RunOptions options;
    if (dimension_of(file) == 2)
      Simulation<2>(file, options, Parameters::Mode::read, comm);
    else
      Simulation<3>(file, options, Parameters::Mode::read, comm);
  }

  std::string
  parameter_template(const ParameterFile &file, const MPI_Comm comm)
  {
    const RunOptions options;
    if (dimension_of(file) == 2)
      return Simulation<2>(file, options, Parameters::Mode::document, comm).document();
    return Simulation<3>(file, options, Parameters::Mode::document, comm).document();
  }
} // namespace Stroma
