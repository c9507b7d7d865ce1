#pragma once

#include <stroma/fem/stokes/method.h>
#include <stroma/simulation/results.h>

#include "../method_state.h"

#include <map>
#include <string>

/// A scene of Stokes flow without the run loop, from the text of a parameter file.
template <int dim>
struct StokesFixture
{
  explicit StokesFixture(const std::string &text, const std::vector<std::string> &set = {}, const double end_time = 1.)
    : file(with(Stroma::ParameterFile::parse(text, "test.prm"), set))
    , parameters(file)
    , scene(parameters, MPI_COMM_WORLD)
  {
    {
      const auto section = parameters.section("FEM");
      settings.add(parameters, scene);
    }
    method = std::make_unique<Stroma::Fem::StokesMethod<dim>>(parameters, scene, settings, end_time, timers);
    parameters.finish();
  }

  static Stroma::ParameterFile
  with(Stroma::ParameterFile file, const std::vector<std::string> &set)
  {
    for (const auto &assignment : set)
      file.set(assignment);
    return file;
  }

  /// Results after @p n_steps equal steps to @p end.
  std::map<std::string, double>
  run(const double end = 1., const unsigned int n_steps = 1)
  {
    method->setup(nullptr);
    for (unsigned int i = 0; i < n_steps; ++i)
      if (method->advance(end * i / n_steps, end * (i + 1) / n_steps, work) != Stroma::StepStatus::ok)
        return {};
    Stroma::Output::Summary summary;
    method->describe(summary);
    for (const auto &[name, value] : method->scalars)
      summary.results[name] = value;
    Stroma::add_results(*method, scene, {}, end, nullptr, summary.results);
    return summary.results;
  }

  Stroma::ParameterFile                           file;
  Stroma::Parameters                              parameters;
  Stroma::Scene<dim>                              scene;
  Stroma::Fem::Settings<dim>                      settings;
  Stroma::Timers                                  timers;
  Stroma::StepWork                                work;
  std::unique_ptr<Stroma::Fem::StokesMethod<dim>> method;
};
