#pragma once

#include <stroma/methods/table.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>

/// A scene with one of the build's methods, without the run loop, from the text of a parameter file.
struct MethodFixture
{
  /// Whether the build has @p method.
  static bool
  has(const std::string &method)
  {
    const auto &table = Stroma::methods<2>();
    return std::any_of(table.begin(), table.end(), [&](const auto &entry) { return entry.name == method; });
  }

  MethodFixture(const std::string &text, const std::string &method, const double end_time = 1.)
    : file(Stroma::ParameterFile::parse(text, "test.prm"))
    , parameters(file)
    , scene(parameters, MPI_COMM_WORLD)
  {
    Stroma::Log::start(true);
    Stroma::Solvers::StepSettings steps;
    steps.end_time = end_time;
    for (const auto &entry : Stroma::methods<2>())
      if (entry.name == method)
        this->method = entry.make(parameters, scene, steps, timers);
    this->method->setup(nullptr);
  }

  /// Takes @p n equal steps from @p begin to @p end; false if one fails.
  bool
  advance(const double begin, const double end, const unsigned int n)
  {
    for (unsigned int i = 0; i < n; ++i)
      if (method->advance(begin + (end - begin) * i / n, begin + (end - begin) * (i + 1) / n, work) !=
          Stroma::StepStatus::ok)
        return false;
    return true;
  }

  std::map<std::string, double>
  scalars() const
  {
    return {method->scalars.begin(), method->scalars.end()};
  }

  Stroma::ParameterFile           file;
  Stroma::Parameters              parameters;
  Stroma::Scene<2>                scene;
  Stroma::Timers                  timers;
  Stroma::StepWork                work;
  std::unique_ptr<Stroma::Method> method;
};
