#pragma once

#include <stroma/fem/solid/method.h>
#include <stroma/mpm/method.h>

#include <map>
#include <memory>
#include <string>

/// A scene with one of the methods for solids, without the run loop, from the text of a parameter file.
struct MethodFixture
{
  /// @param method "mpm" or "fem"
  MethodFixture(const std::string &text, const std::string &method, const double end_time = 1.)
    : file(Stroma::ParameterFile::parse(text, "test.prm"))
    , parameters(file)
    , scene(parameters, MPI_COMM_WORLD)
  {
    Stroma::Log::start(true);
    Stroma::Fem::Settings<2> fem;
    {
      const auto section = parameters.section("FEM");
      fem.add(parameters, scene);
    }
    if (method == "mpm")
      this->method = std::make_unique<Stroma::Mpm::MpmMethod<2>>(parameters, scene, end_time, timers);
    else
      this->method = std::make_unique<Stroma::Fem::SolidMethod<2>>(parameters, scene, fem, end_time, timers);
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
