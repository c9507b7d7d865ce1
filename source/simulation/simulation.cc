#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/signals.h>
#include <stroma/base/text.h>
#include <stroma/output/archive.h>
#include <stroma/output/checkpoints.h>
#include <stroma/output/folder.h>
#include <stroma/output/pvd.h>
#include <stroma/output/series.h>
#include <stroma/output/text_file.h>
#include <stroma/scene/image_report.h>
#include <stroma/simulation/problem.h>
#include <stroma/simulation/results.h>
#include <stroma/simulation/same_scene.h>
#include <stroma/simulation/saved_run.h>
#include <stroma/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

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
      bool                     fields_are_due() const;
      void                     write_row();
      Output::TimeSeries::Row  row() const;
      void                     write_fields();
      Output::PvdSeries       &record_list(const std::string &file_name);
      std::string              save_checkpoint();
      void                     write_archive(const std::string &path);
      void                     complete_summary(RunStatus status);
      std::string              progress(const StepWork &work) const;

      const ParameterFile                     &file;
      const RunOptions                        &options;
      MPI_Comm                                 comm;
      Timers                                   timers;
      Problem<dim>                             problem;
      const Parameters                        &parameters;
      const std::unique_ptr<Scene<dim>>       &scene;
      const Solvers::StepSettings             &step_settings;
      const OutputSettings                    &output;
      const std::unique_ptr<Method>           &method;
      std::unique_ptr<Output::RunFolder>       folder;
      std::unique_ptr<Solvers::StepControl>    control;
      std::unique_ptr<Output::TimeSeries>      series;
      std::map<std::string, Output::PvdSeries> records; ///< by file name

      double          time = 0., start_time = 0., fields_time = -1., checkpoint_time = -1.;
      unsigned int    steps = 0, field_files = 0;
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
      Log::line("Stroma " STROMA_VERSION ", " + std::to_string(dealii::Utilities::MPI::n_mpi_processes(comm)) +
                " rank(s): " + (scene->title.empty() ? file.path() : scene->title));
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
      series = std::make_unique<Output::TimeSeries>(folder->file("series.csv"), comm);
      if (archive && archive->attribute_double("time") >= step_settings.end_time && has_finished(folder->path(), comm))
        return nothing_to_do();
      on_root(comm, [&] { Output::write_atomically(folder->file("parameters.prm"), parameters.print(true)); });
      if (archive)
        resume(*archive);
      else
        write_row();
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
                   grouped(summary.n_points) + " points of " + brief(summary.bytes_per_point) + " bytes, " :
                   "") +
                grouped(summary.n_cells) + " cells, " + grouped(summary.n_dofs) + " unknowns");
      for (const auto &law : summary.laws)
        Log::line("  " + law);
      Log::line("  uses:      " + join(summary.used, ", "));
      Log::line("  leaves out: " + join(summary.left_out, ", "));
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
      for (const auto &name : scene->unused_materials())
        Log::warning("no body is made of material '" + name + "'");
      forget_not_finite();
      method->setup(archive);
      if (archive)
        method->scalars = load_scalars(*archive, comm);
      if (const auto message = first_not_finite(comm); !message.empty())
        throw UserError(message);
      Output::check_names(row());
    }

    template <int dim>
    RunResult
    Simulation<dim>::finish(RunStatus status)
    {
      std::string not_saved = status == RunStatus::finished ? "" : save_checkpoint();
      try
        {
          write_fields();
        }
      catch (const OutputError &error)
        {
          fail_to_write(error, status);
          not_saved = save_checkpoint();
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
      return {status, summary, folder->path(), is_of_output, checkpoint_time == time};
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
      time = start_time            = archive.attribute_double("time");
      steps                        = archive.attribute_uint64("steps");
      field_files                  = archive.attribute_uint64("field_files");
      summary.newton_iterations    = archive.attribute_uint64("newton_iterations");
      summary.linear_iterations    = archive.attribute_uint64("linear_iterations");
      summary.residual_evaluations = archive.attribute_uint64("residual_evaluations");
      std::istringstream  text(archive.attribute_string("step_control"));
      std::vector<double> state;
      for (std::string hex; text >> hex;)
        state.push_back(std::strtod(hex.c_str(), nullptr));
      control->load(state);
      Output::remove_later_steps(folder->path(), steps, comm);
      // A stop may have written fields after its checkpoint: these files keep their times.
      bool has_fields = false;
      for (const auto &name : Output::series_files(folder->path(), comm))
        {
          const auto &list = record_list(name);
          field_files      = std::max(field_files, list.next_number());
          has_fields       = list.has(time) || has_fields;
        }
      // What is missing is what a full disk did not take.
      if (!series->resume(time))
        write_row();
      if (!has_fields && fields_are_due())
        write_fields();
      Log::line("  continues at t = " + brief(time) + " s after " + std::to_string(steps) + " steps");
    }

    template <int dim>
    RunStatus
    Simulation<dim>::step_to_end()
    {
      try
        {
          while (time < step_settings.end_time)
            {
              if (stop_requested(comm))
                return RunStatus::stopped;
              if (const auto ending = take_step())
                return *ending;
            }
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
      const auto control_before = control->save();
      StepWork   all_work;
      while (true)
        {
          const double     next = control->next(time);
          StepWork         work;
          const StepStatus status = method->advance(time, next, work);
          all_work.newton_iterations += work.newton_iterations;
          all_work.linear_iterations += work.linear_iterations;
          all_work.residual_evaluations += work.residual_evaluations;
          const std::string not_finite = first_not_finite(comm);
          if (status == StepStatus::ok)
            {
              summary.newton_iterations += all_work.newton_iterations;
              summary.linear_iterations += all_work.linear_iterations;
              summary.residual_evaluations += all_work.residual_evaluations;
              control->accept(work.hardest_solve, work.longest_next);
              time = next;
              ++steps;
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
    bool
    Simulation<dim>::fields_are_due() const
    {
      const double same     = 2e-12 * step_settings.end_time; // steps end at one of several times so close
      const bool   is_asked = std::any_of(output.fields_at.begin(), output.fields_at.end(),
                                          [&](const double t) { return std::abs(t - time) <= same; });
      return is_asked || (output.fields_every > 0 && steps % output.fields_every == 0);
    }

    template <int dim>
    void
    Simulation<dim>::after_step(const StepWork &work)
    {
      write_row();
      Log::line(progress(work));
      if (fields_are_due())
        write_fields();
      if (output.checkpoint_every > 0 && steps % output.checkpoint_every == 0)
        if (const std::string reason = save_checkpoint(); !reason.empty())
          Log::warning("no checkpoint at t = " + brief(time) + " s: " + reason + "; earlier checkpoints stay usable");
    }

    template <int dim>
    std::string
    Simulation<dim>::progress(const StepWork &work) const
    {
      const double done = (time - start_time) / (step_settings.end_time - start_time);
      const double left = timers.total() * (1 - done) / done;
      char         line[200];
      std::snprintf(line, sizeof(line),
                    "  step %u: t = %.6g s (%.0f %%), %u Newton, %u CG iterations; %s gone, about %s left", steps, time,
                    100 * time / step_settings.end_time, work.newton_iterations, work.linear_iterations,
                    duration(timers.total()).c_str(), duration(left).c_str());
      return line;
    }

    template <int dim>
    Output::TimeSeries::Row
    Simulation<dim>::row() const
    {
      Output::TimeSeries::Row row = {{"time_s", time}};
      for (const auto &scalar : method->scalars)
        row.push_back(scalar);
      for (const auto &scalar : problem.probes.scalars(*method))
        row.push_back(scalar);
      row.emplace_back("newton_iterations", summary.newton_iterations);
      row.emplace_back("linear_iterations", summary.linear_iterations);
      return row;
    }

    template <int dim>
    void
    Simulation<dim>::write_row()
    {
      const auto scope = timers.scope("series");
      series->add(row());
    }

    /// The list of records in a file of the folder, with those up to the start if the run was resumed.
    template <int dim>
    Output::PvdSeries &
    Simulation<dim>::record_list(const std::string &file_name)
    {
      auto found = records.find(file_name);
      if (found == records.end())
        {
          found = records.emplace(file_name, Output::PvdSeries(folder->file(file_name), comm)).first;
          if (options.resume)
            found->second.restore(start_time);
        }
      return found->second;
    }

    template <int dim>
    void
    Simulation<dim>::write_fields()
    {
      if (fields_time == time)
        return;
      fields_time = time;
      if (output.keep_states)
        write_archive(state_path(folder->path(), steps, comm));
      const auto                 scope = timers.scope("field files");
      const Output::FieldRequest request{folder->path(), field_files, output.point_fields, output.grid_fields,
                                         output.format};
      if (method->facts.writes_points && !output.point_fields.empty())
        {
          const auto record = Output::write_points(*method->state(false), dim, request, comm);
          record_list(output.format == Output::Format::xdmf ? "points.xdmf" : "points.pvd").add(time, record);
        }
      if (const auto record = method->write_grid(request); !record.empty())
        record_list("grid.pvd").add(time, record);
      ++field_files;
    }

    template <int dim>
    void
    Simulation<dim>::write_archive(const std::string &path)
    {
      Output::ArchiveWriter archive(path, comm);
      archive.attribute("version", std::string(STROMA_VERSION));
      archive.attribute("parameters", scene_text(parameters, file, file_checksums(*scene)));
      archive.attribute("steps", std::uint64_t(steps));
      archive.attribute("field_files", std::uint64_t(field_files));
      archive.attribute("newton_iterations", summary.newton_iterations);
      archive.attribute("linear_iterations", summary.linear_iterations);
      archive.attribute("residual_evaluations", summary.residual_evaluations);
      std::ostringstream state;
      state << std::hexfloat;
      for (const double number : control->save())
        state << number << ' ';
      archive.attribute("step_control", state.str());
      {
        const auto scope = timers.scope("checkpoint");
        save_scalars(method->scalars, archive, comm);
        method->save(archive);
      }
      archive.commit();
    }

    /// Returns why there is none, or "".
    template <int dim>
    std::string
    Simulation<dim>::save_checkpoint()
    {
      if (checkpoint_time == time)
        return "";
      const Output::Checkpoints checkpoints(folder->path(), comm);
      try
        {
          write_archive(checkpoints.path(steps));
        }
      catch (const OutputError &error)
        {
          return error.what();
        }
      checkpoint_time = time;
      checkpoints.remove_old();
      return "";
    }

    template <int dim>
    void
    Simulation<dim>::complete_summary(const RunStatus status)
    {
      summary.used.clear();
      summary.left_out.clear();
      method->describe(summary);
      for (const auto &scalars : {method->scalars, problem.probes.scalars(*method)})
        for (const auto &[name, value] : scalars)
          summary.results[name] = value;
      {
        const auto scope = timers.scope("results");
        add_results(*method, *scene, time, summary.results);
      }
      summary.status                = status == RunStatus::finished ? "finished" :
                                      status == RunStatus::stopped  ? "stopped: asked to stop; continue with --resume" :
                                                                      "failed: " + failure;
      summary.title                 = scene->title;
      summary.parameter_file        = file.path();
      summary.n_ranks               = dealii::Utilities::MPI::n_mpi_processes(comm);
      summary.n_steps               = steps;
      summary.results["end_time_s"] = time;
      summary.results.merge(report_images(*scene).results);
      for (const auto &[name, seconds] : timers.phases())
        summary.phases.emplace_back(name, seconds);
      summary.peak_memory_bytes = dealii::Utilities::MPI::sum(std::uint64_t(peak_memory_bytes()), comm);
      summary.wall_time_s       = timers.total();
      if (const auto names = summary.without_value(); !names.empty())
        Log::warning("these results are no finite numbers: " + join(names, ", "));
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
