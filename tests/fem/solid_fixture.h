#pragma once

#include <stroma/fem/solid/method.h>
#include <stroma/simulation/results.h>

#include "../method_state.h"

#include <algorithm>
#include <map>
#include <random>
#include <string>

/// What finite elements need of a solid's scene, from the text of a parameter file.
template <int dim>
struct SceneFixture
{
  explicit SceneFixture(const std::string &text, const std::vector<std::string> &set = {})
    : file(with(Stroma::ParameterFile::parse(text, "test.prm"), set))
    , parameters(file)
    , scene(parameters, MPI_COMM_WORLD)
  {
    const auto section = parameters.section("FEM");
    settings.add(parameters, scene);
  }

  static Stroma::ParameterFile
  with(Stroma::ParameterFile file, const std::vector<std::string> &set)
  {
    for (const auto &assignment : set)
      file.set(assignment);
    return file;
  }

  Stroma::ParameterFile      file;
  Stroma::Parameters         parameters;
  Stroma::Scene<dim>         scene;
  Stroma::Fem::Settings<dim> settings;
  Stroma::Timers             timers;
};

/// A solid's scene with its method, without the run loop.
template <int dim>
struct SolidFixture : SceneFixture<dim>
{
  explicit SolidFixture(const std::string &text, const std::vector<std::string> &set = {}, const double end_time = 1.)
    : SceneFixture<dim>(text, set)
    , method(std::make_unique<Stroma::Fem::SolidMethod<dim>>(this->parameters, this->scene, this->settings, end_time,
                                                             this->timers))
  {
    this->parameters.finish();
    Stroma::Log::start(true);
  }

  /// Takes @p n_steps equal steps from @p begin to @p end; false if one fails.
  bool
  advance(const double begin, const double end, const unsigned int n_steps = 1)
  {
    const auto at = [&](const unsigned int i) { return begin + (end - begin) * i / n_steps; };
    for (unsigned int i = 0; i < n_steps; ++i)
      if (method->advance(at(i), at(i + 1), work) != Stroma::StepStatus::ok)
        return false;
    return true;
  }

  std::map<std::string, double>
  scalars() const
  {
    return {method->scalars.begin(), method->scalars.end()};
  }

  /// Results of the whole run.
  std::map<std::string, double>
  results()
  {
    Stroma::Output::Summary summary;
    method->describe(summary);
    return summary.results;
  }

  Stroma::StepWork                               work;
  std::unique_ptr<Stroma::Fem::SolidMethod<dim>> method;
};

/// The parts of a solid's method, one by one.
template <int dim>
struct PartsFixture : SceneFixture<dim>
{
  explicit PartsFixture(const std::string &text, const std::vector<std::string> &set = {})
    : SceneFixture<dim>(text, set)
    , mesh(this->scene, this->settings)
  {
    this->parameters.finish();
  }

  /// Numbers the unknowns of the present mesh.
  void
  number(const double end_time = 1.)
  {
    unknowns = std::make_unique<Stroma::Fem::Unknowns<dim>>(this->scene, this->settings, mesh, end_time);
  }

  Stroma::Fem::LoadedSpace<dim>
  space() const
  {
    return {unknowns->dofs, unknowns->fe, unknowns->ties, unknowns->owned};
  }

  Stroma::Fem::Mesh<dim>                      mesh;
  std::unique_ptr<Stroma::Fem::Unknowns<dim>> unknowns;
};

/// A section of a parameter file with one named subsection.
inline std::string
one(const std::string &section, const std::string &name, const std::string &entries)
{
  return "subsection " + section + "\n subsection " + name + "\n" + entries + " end\nend\n";
}

/// A neo-Hookean material 'gel' with @p more entries.
inline std::string
gel(const std::string &more = "")
{
  return one("Materials", "gel", "  set Shear modulus = 2\n  set Bulk modulus = 5\n" + more);
}

/// Reproducible numbers between -size/2 and size/2.
inline std::vector<double>
random_numbers(const unsigned int n, const double size, const unsigned int seed)
{
  std::mt19937        random(seed);
  std::vector<double> numbers(n);
  for (double &number : numbers)
    number = size * (random() / 4294967295. - .5);
  return numbers;
}
