#pragma once

#include <stroma/scene/scene.h>
#include <stroma/simulation/method.h>

#include <map>
#include <string>

namespace Stroma
{
  /// What every method reports of its sample points at @p time [s]: quantiles of the von Mises stress, and errors against the
  /// scene's exact solution. Collective.
  template <int dim>
  void add_results(Method &method, const Scene<dim> &scene, double time, std::map<std::string, double> &results);
} // namespace Stroma
