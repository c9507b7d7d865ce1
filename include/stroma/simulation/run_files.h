#pragma once

#include <stroma/output/point_results.h>
#include <stroma/output/series.h>
#include <stroma/simulation/field_files.h>
#include <stroma/simulation/problem.h>
#include <stroma/simulation/run_state.h>

namespace Stroma
{
  /// What series.csv tells of the state that the method of @p problem has committed. Collective.
  template <int dim>
  Output::TimeSeries::Row series_row(const Problem<dim> &problem, const RunState &so_far);

  /// What a run writes into its folder as it goes: rows of series.csv, field files, states that are kept, checkpoints. All functions are
  /// collective; they throw OutputError where nothing else is said.
  template <int dim>
  class RunFiles
  {
  public:
    /// @param folder that is open @param so_far of the run, which a checkpoint holds. All must outlive this.
    RunFiles(const std::string &folder, const ParameterFile &file, const Problem<dim> &problem,
             const Solvers::StepControl &control, RunState &so_far, Timers &timers, MPI_Comm comm);

    /// Takes over the files of a run that goes on from the present state, and writes what they lack of it.
    void resume();

    void write_row();
    /// Those of the present state, once.
    void write_fields();
    void write_fields_if_due();

    /// Returns why there is none, or "".
    std::string save_checkpoint();
    /// Whether the present state is in a checkpoint that this has written.
    bool
    has_checkpoint() const
    {
      return checkpoint_time == problem.method->time;
    }

    /// Results of the points at the end, where writing fields has had a walk over them; else null.
    const Output::PointResults *
    of_points() const
    {
      return collected.get();
    }

  private:
    bool fields_are_due() const;
    void write_archive(const std::string &path);

    const std::string                     folder;
    const ParameterFile                  &file;
    const Problem<dim>                   &problem;
    const Solvers::StepControl           &control;
    RunState                             &so_far;
    Timers                               &timers;
    const MPI_Comm                        comm;
    Output::TimeSeries                    series;
    FieldFiles                            fields;
    std::unique_ptr<Output::PointResults> collected;
    double                                fields_time = -1., checkpoint_time = -1.;
  };
} // namespace Stroma
