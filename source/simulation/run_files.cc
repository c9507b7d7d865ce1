#include <stroma/output/archive.h>
#include <stroma/output/checkpoints.h>
#include <stroma/simulation/results.h>
#include <stroma/simulation/run_files.h>
#include <stroma/simulation/same_scene.h>
#include <stroma/simulation/saved_run.h>
#include <stroma/simulation/saved_state.h>

#include <algorithm>
#include <cmath>

namespace Stroma
{
  namespace
  {
    template <int dim>
    const VoxelMaterials *
    first_image(const Scene<dim> &scene)
    {
      for (const auto &body : scene.bodies)
        if (body.is_image())
          return &body.voxels;
      return nullptr;
    }
  } // namespace

  template <int dim>
  Output::TimeSeries::Row
  series_row(const Problem<dim> &problem, const RunState &so_far)
  {
    Output::TimeSeries::Row row = {{"time_s", problem.method->time}};
    for (const auto &scalar : problem.method->scalars)
      row.push_back(scalar);
    for (const auto &scalar : problem.probes.scalars(*problem.method))
      row.push_back(scalar);
    row.emplace_back("newton_iterations", so_far.newton_iterations);
    row.emplace_back("linear_iterations", so_far.linear_iterations);
    return row;
  }

  template <int dim>
  RunFiles<dim>::RunFiles(const std::string &folder, const ParameterFile &file, const Problem<dim> &problem,
                          const Solvers::StepControl &control, RunState &so_far, Timers &timers, const MPI_Comm comm)
    : folder(folder)
    , file(file)
    , problem(problem)
    , control(control)
    , so_far(so_far)
    , timers(timers)
    , comm(comm)
    , series(folder + "/series.csv", comm)
    , fields(problem.output, folder, dim, problem.scene->material_names, first_image(*problem.scene), comm)
  {}

  /// What is missing is what a full disk did not take.
  template <int dim>
  void
  RunFiles<dim>::resume()
  {
    Output::remove_later_steps(folder, so_far.steps, comm);
    const bool has_fields = fields.resume(problem.method->time, so_far.field_files);
    if (!series.resume(problem.method->time))
      write_row();
    if (!has_fields)
      write_fields_if_due();
  }

  template <int dim>
  void
  RunFiles<dim>::write_row()
  {
    const auto scope = timers.scope("series");
    series.add(series_row(problem, so_far));
  }

  template <int dim>
  bool
  RunFiles<dim>::fields_are_due() const
  {
    const OutputSettings &output = problem.output;
    const double          same   = 2e-12 * problem.step_settings.end_time; // steps end at one of several times so close
    const bool            is_asked = std::any_of(output.fields_at.begin(), output.fields_at.end(),
                                                 [&](const double t) { return std::abs(t - problem.method->time) <= same; });
    const bool            is_start = so_far.steps == 0 && !output.fields_at.empty(); // a series begins there
    return is_start || is_asked || (output.fields_every > 0 && so_far.steps % output.fields_every == 0);
  }

  template <int dim>
  void
  RunFiles<dim>::write_fields_if_due()
  {
    if (fields_are_due())
      write_fields();
  }

  template <int dim>
  void
  RunFiles<dim>::write_fields()
  {
    Method &method = *problem.method;
    if (fields_time == method.time)
      return;
    fields_time = method.time;
    if (problem.output.keep_states && so_far.steps > 0)
      write_archive(state_path(folder, so_far.steps, comm));
    const auto scope = timers.scope("field files");
    collected.reset();
    if (method.time < problem.step_settings.end_time || !fields.visits_points())
      {
        fields.write(method);
        return;
      }
    auto results = collect_results(method, *problem.scene, problem.output);
    fields.write(method,
                 results ? [&](const Output::PointState &point) { results->add(point); } : Output::StateView::Visit());
    collected = std::move(results);
  }

  template <int dim>
  void
  RunFiles<dim>::write_archive(const std::string &path)
  {
    Output::ArchiveWriter archive(path, comm);
    archive.attribute("version", std::string(STROMA_VERSION));
    archive.attribute("parameters", scene_text(problem.parameters, file, file_checksums(*problem.scene)));
    so_far.field_files  = fields.counter();
    so_far.step_control = control.save();
    so_far.save(archive);
    {
      const auto scope = timers.scope("checkpoint");
      save_state(*problem.method, archive, comm);
    }
    archive.commit();
  }

  template <int dim>
  std::string
  RunFiles<dim>::save_checkpoint()
  {
    if (has_checkpoint())
      return "";
    const Output::Checkpoints checkpoints(folder, comm);
    try
      {
        write_archive(checkpoints.path(so_far.steps));
      }
    catch (const OutputError &error)
      {
        return error.what();
      }
    checkpoint_time = problem.method->time;
    checkpoints.remove_old();
    return "";
  }

  template Output::TimeSeries::Row series_row<2>(const Problem<2> &, const RunState &);
  template Output::TimeSeries::Row series_row<3>(const Problem<3> &, const RunState &);
  template class RunFiles<2>;
  template class RunFiles<3>;
} // namespace Stroma
