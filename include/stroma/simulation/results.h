#pragma once

#include <stroma/scene/scene.h>
#include <stroma/simulation/method.h>
#include <stroma/simulation/output_settings.h>

#include <map>
#include <string>

namespace Stroma
{
  /// What results of the body @p body carry, so that they are told from those of a material.
  std::string body_result_name(const std::string &body);

  /// What every method reports of its sample points at @p time [s]: quantiles of the von Mises stress, numbers of each
  /// material and, where asked, of each body, and errors against the scene's exact solution. Collective.
  template <int dim>
  void add_results(Method &method, const Scene<dim> &scene, const OutputSettings &output, double time,
                   std::map<std::string, double> &results);
} // namespace Stroma
