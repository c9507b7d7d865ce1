#pragma once

#include <stroma/base/log.h>
#include <stroma/base/parameters.h>
#include <stroma/methods/table.h>
#include <stroma/scene/scene.h>
#include <stroma/simulation/method.h>
#include <stroma/simulation/output_settings.h>
#include <stroma/simulation/probes.h>
#include <stroma/solvers/step_control.h>

#include <memory>

namespace Stroma
{
  /// A parameter file, read: the scene, the method it names, and how to step and what to write.
  template <int dim>
  class Problem
  {
  public:
    /// Throws UserError for anything that cannot be used: first for what is unknown, then for what is missing. Collective.
    Problem(const ParameterFile &file, Parameters::Mode mode, MPI_Comm comm, Timers &timers);

    /// The method anew, for another state: a method is set up once.
    void make_method(Timers &timers);

    Parameters                  parameters;
    Solvers::StepSettings       step_settings;
    std::unique_ptr<Scene<dim>> scene;
    std::unique_ptr<Method>     method;
    Probes<dim>                 probes;
    OutputSettings              output;

  private:
    void                    read(const ParameterFile &file, MPI_Comm comm, Timers &timers);
    const MethodEntry<dim> &choose_method();

    void check_results_by_body() const;
  };

  /// The space dimension that a file names, 3 by default. Throws UserError.
  unsigned int dimension_of(const ParameterFile &file);
} // namespace Stroma
