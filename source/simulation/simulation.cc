#include <stroma/base/log.h>
#include <stroma/base/on_root.h>
#include <stroma/base/signals.h>
#include <stroma/base/text.h>
#include <stroma/output/archive.h>
#include <stroma/output/checkpoints.h>
#include <stroma/output/folder.h>
#include <stroma/output/pvd.h>
#include <stroma/output/series.h>
#include <stroma/simulation/problem.h>
#include <stroma/simulation/saved_run.h>
#include <stroma/simulation/simulation.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>

namespace Stroma
{
  namespace
  {
    /// One run from reading to the last file.
    template <int dim>
    class Simulation
    {
    public:
      Simulation(const ParameterFile &file, const RunOptions &options, Parameters::Mode mode, MPI_Comm comm);

      RunResult   run();
      std::string document() const { return parameters.print(true); }

    private:
      void        set_up();
      void        open_folder();
      void        resume(const Output::ArchiveReader &archive);
      void        check_same_scene(const Output::ArchiveReader &archive, const std::string &path) const;
      RunStatus   step_to_end();
      bool        take_step();
      void        after_step(const StepWork &work);
      void        write_row();
      void        write_fields();
      void        save_checkpoint();
      void        write_archive(const std::string &path);
      void        complete_summary(RunStatus status);
      std::string progress(const StepWork &work) const;

      const ParameterFile                 &file;
      const RunOptions                    &options;
      MPI_Comm                             comm;
      Timers                               timers;
      Problem<dim>                         problem;
      const Parameters                    &parameters;
      const std::unique_ptr<Scene<dim>>   &scene;
      const Solvers::StepSettings         &step_settings;
      const OutputSettings                &output;
      const std::unique_ptr<Method>       &method;
      std::unique_ptr<Output::RunFolder>   folder;
      std::unique_ptr<Solvers::StepControl> control;
      std::unique_ptr<Output::TimeSeries>  series;
      std::map<std::string, Output::PvdSeries> records;

      double          time = 0., start_time = 0., fields_time = -1., checkpoint_time = -1.;
      unsigned int    steps = 0, field_files = 0;
      std::string     failure;
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

    template <int dim>
    RunResult
    Simulation<dim>::run()
    {
      if (options.check)
        {
          set_up();
          method->describe(summary);
          Output::check_names(method->scalars());
          return {RunStatus::checked, summary, ""};
        }
      open_folder();
      Log::line("Stroma " STROMA_VERSION ", " +
                std::to_string(dealii::Utilities::MPI::n_mpi_processes(comm)) + " rank(s): " +
                (scene->title.empty() ? file.path() : scene->title));
      auto must_hit = method->times_to_meet();
      must_hit.insert(must_hit.end(), output.fields_at.begin(), output.fields_at.end());
      control = std::make_unique<Solvers::StepControl>(step_settings, must_hit);
      series  = std::make_unique<Output::TimeSeries>(folder->file("series.csv"), comm);

      const std::string checkpoint = options.resume ? Output::Checkpoints(folder->path(), comm).latest() : "";
      if (options.resume && checkpoint.empty())
        throw UserError("--resume: folder '" + folder->path() + "' holds no complete checkpoint; run without --resume");
      if (!checkpoint.empty())
        {
          const Output::ArchiveReader archive(checkpoint, comm);
          check_same_scene(archive, checkpoint);
          resume(archive);
        }
      else
        {
          on_root(comm, [&] {
            std::ofstream out(folder->file("parameters.prm"));
            out << parameters.print(true);
            if (!out.flush())
              throw UserError(folder->file("parameters.prm") + ": cannot be written");
          });
          set_up();
          write_row();
        }
      method->describe(summary);
      Log::line("  " + (summary.n_points > 0 ? grouped(summary.n_points) + " points of " + brief(summary.bytes_per_point) +
                                                 " bytes, " : "") +
                grouped(summary.n_cells) + " cells, " + grouped(summary.n_dofs) + " unknowns");
      Log::line("  uses:      " + join(summary.used, ", "));
      Log::line("  leaves out: " + join(summary.left_out, ", "));

      const RunStatus status = step_to_end();
      if (status != RunStatus::finished)
        save_checkpoint();
      write_fields();
      complete_summary(status);
      return {status, summary, folder->path()};
    }

    /// The start of a run, which must be finite.
    template <int dim>
    void
    Simulation<dim>::set_up()
    {
      for (const auto &name : scene->unused_materials())
        Log::warning("no body is made of material '" + name + "'");
      forget_not_finite();
      method->setup(nullptr);
      if (const auto message = first_not_finite(comm); !message.empty())
        throw UserError(message);
    }

    template <int dim>
    void
    Simulation<dim>::open_folder()
    {
      Output::FolderRequest request;
      request.output         = options.output;
      request.parameter_file = file.path();
      request.overwrite      = options.overwrite;
      request.resume         = options.resume;
      folder                 = std::make_unique<Output::RunFolder>(request, comm);
    }

    template <int dim>
    void
    Simulation<dim>::check_same_scene(const Output::ArchiveReader &archive, const std::string &path) const
    {
      const std::string version = archive.attribute_string("version");
      if (version != STROMA_VERSION)
        throw UserError(path, "this checkpoint was written by Stroma " + version + ", this is " STROMA_VERSION
                              "; resume with that version, or start anew with --overwrite");
      // Everything but output and the end of time must be as it was.
      const auto relevant = [](const std::string &name) {
        return name.rfind("Output/", 0) != 0 && name.rfind("Units/", 0) != 0 && name != "Title" &&
               name != "Time/End" && name != "Memory limit";
      };
      std::map<std::string, std::string> before, now;
      std::istringstream                 text(archive.attribute_string("parameters"));
      for (std::string line; std::getline(text, line);)
        if (const auto tab = line.find('\t'); tab != std::string::npos)
          before[line.substr(0, tab)] = line.substr(tab + 1);
      now = parameters.values();
      for (const auto *list : {&before, &now})
        for (const auto &entry : *list)
          {
            const std::string &name = entry.first;
            const auto         old = before.count(name) ? before.at(name) : "(nothing)";
            const auto         given = now.count(name) ? now.at(name) : "(nothing)";
            if (relevant(name) && old != given)
              throw UserError(path, "this checkpoint is of another scene: '" + name + "' was " + old + " and is now " +
                                      given + "; resume with the old value, or start anew with --overwrite");
          }
    }

    template <int dim>
    void
    Simulation<dim>::resume(const Output::ArchiveReader &archive)
    {
      method->setup(&archive);
      time = start_time = archive.attribute_double("time");
      steps             = archive.attribute_uint64("steps");
      field_files       = archive.attribute_uint64("field_files");
      summary.newton_iterations    = archive.attribute_uint64("newton_iterations");
      summary.linear_iterations    = archive.attribute_uint64("linear_iterations");
      summary.residual_evaluations = archive.attribute_uint64("residual_evaluations");
      std::istringstream  text(archive.attribute_string("step_control"));
      std::vector<double> state;
      for (std::string hex; text >> hex;)
        state.push_back(std::strtod(hex.c_str(), nullptr));
      control->load(state);
      series->resume(time);
      Log::line("  continues at t = " + brief(time) + " s after " + std::to_string(steps) + " steps");
    }

    template <int dim>
    RunStatus
    Simulation<dim>::step_to_end()
    {
      while (time < step_settings.end_time)
        {
          if (stop_requested(comm))
            return RunStatus::stopped;
          if (!take_step())
            return RunStatus::failed;
        }
      return RunStatus::finished;
    }

    template <int dim>
    bool
    Simulation<dim>::take_step()
    {
      while (true)
        {
          const double     next = control->next(time);
          StepWork         work;
          const StepStatus status = method->advance(time, next, work);
          summary.newton_iterations += work.newton_iterations;
          summary.linear_iterations += work.linear_iterations;
          summary.residual_evaluations += work.residual_evaluations;
          const std::string not_finite = first_not_finite(comm);
          if (status == StepStatus::ok)
            {
              control->accept(work.hardest_solve);
              time = next;
              ++steps;
              after_step(work);
              failure = not_finite;
              return not_finite.empty();
            }
          failure = std::string(to_string(status)) + " in the step from t = " + brief(time) + " to " +
                    brief(next) + " s";
          if (!not_finite.empty()) // a shorter step cannot help
            {
              failure = not_finite;
              return false;
            }
          if (status == StepStatus::linear_failed)
            failure += "; a part of the bodies may be held by next to nothing";
          Log::line("  step cut: " + failure);
          if (status == StepStatus::left_grid || stop_requested(comm) || !control->reject())
            return false;
        }
    }

    template <int dim>
    void
    Simulation<dim>::after_step(const StepWork &work)
    {
      write_row();
      Log::line(progress(work));
      // Times to meet that are equal up to round-off are one time (StepControl), as 3*0.1 and 0.3.
      const double same     = 1e-12 * step_settings.end_time;
      const bool   is_asked = std::any_of(output.fields_at.begin(), output.fields_at.end(),
                                        [&](const double asked) { return std::abs(asked - time) <= same; });
      if (is_asked || (output.fields_every > 0 && steps % output.fields_every == 0))
        write_fields();
      if (output.checkpoint_every > 0 && steps % output.checkpoint_every == 0)
        save_checkpoint();
    }

    template <int dim>
    std::string
    Simulation<dim>::progress(const StepWork &work) const
    {
      const double done = (time - start_time) / (step_settings.end_time - start_time);
      const double left = timers.total() * (1 - done) / done;
      char         line[200];
      std::snprintf(line, sizeof(line), "  step %u: t = %.6g s (%.0f %%), %u Newton, %u CG iterations; %s gone, about %s left",
                    steps, time, 100 * time / step_settings.end_time, work.newton_iterations, work.linear_iterations,
                    duration(timers.total()).c_str(), duration(left).c_str());
      return line;
    }

    template <int dim>
    void
    Simulation<dim>::write_row()
    {
      const auto              scope = timers.scope("series");
      Output::TimeSeries::Row row   = {{"time_s", time}};
      for (const auto &scalar : method->scalars())
        row.push_back(scalar);
      row.emplace_back("newton_iterations", summary.newton_iterations);
      row.emplace_back("linear_iterations", summary.linear_iterations);
      series->add(row);
    }

    template <int dim>
    void
    Simulation<dim>::write_fields()
    {
      if (fields_time == time)
        return;
      fields_time = time;
      if (output.keep_states)
        write_archive(state_path(folder->path(), steps));
      const FieldRequest request{folder->path(), field_files++, output.point_fields, output.grid_fields, output.format};
      for (const auto &[name, record] : method->write_fields(request))
        {
          if (records.count(name) == 0)
            {
              const std::string ending = record.substr(record.find_last_of('.')) == ".xdmf" ? ".xdmf" : ".pvd";
              const auto        entry  = records.emplace(name, Output::PvdSeries(folder->file(name + ending), comm));
              if (options.resume)
                entry.first->second.restore(start_time);
            }
          records.at(name).add(time, record);
        }
    }

    template <int dim>
    void
    Simulation<dim>::write_archive(const std::string &path)
    {
      Output::ArchiveWriter archive(path, comm);
      archive.attribute("version", std::string(STROMA_VERSION));
      std::string text;
      for (const auto &[name, value] : parameters.values())
        text += name + '\t' + value + '\n';
      archive.attribute("parameters", text);
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
      method->save(archive);
      archive.commit();
    }

    template <int dim>
    void
    Simulation<dim>::save_checkpoint()
    {
      if (checkpoint_time == time)
        return;
      checkpoint_time = time;
      const Output::Checkpoints checkpoints(folder->path(), comm);
      try
        {
          write_archive(checkpoints.path(steps));
          method->go_on_as_resumed();
        }
      catch (const UserError &error)
        {
          Log::warning(std::string("no checkpoint at t = ") + brief(time) + " s: " + error.what() +
                       "; earlier checkpoints stay usable");
          return;
        }
      checkpoints.remove_old();
    }

    template <int dim>
    void
    Simulation<dim>::complete_summary(const RunStatus status)
    {
      summary.used.clear();
      summary.left_out.clear();
      method->describe(summary);
      summary.status = status == RunStatus::finished ? "finished" :
                       status == RunStatus::stopped  ? "stopped: asked to stop; continue with --resume" :
                                                       "failed: " + failure;
      summary.title          = scene->title;
      summary.parameter_file = file.path();
      summary.n_ranks        = dealii::Utilities::MPI::n_mpi_processes(comm);
      summary.n_steps        = steps;
      summary.results["end_time_s"] = time;
      for (const auto &[name, seconds] : timers.phases())
        summary.phases.emplace_back(name, seconds);
      summary.peak_memory_bytes = dealii::Utilities::MPI::sum(std::uint64_t(peak_memory_bytes()), comm);
      summary.wall_time_s       = timers.total();
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
