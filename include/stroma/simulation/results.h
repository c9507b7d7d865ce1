#pragma once

#include <stroma/output/point_results.h>
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
  /// @param collected those of the points, where they are known already
  /// Returns the histograms that @p output asks for.
  template <int dim>
  std::vector<Output::Histogram> add_results(Method &method, const Scene<dim> &scene, const OutputSettings &output,
                                             double time, const Output::PointResults *collected,
                                             std::map<std::string, double> &results);

  /// To collect those of the points, where they are visited anyway; nothing where they ask for more than such a visit shows.
  template <int dim>
  std::unique_ptr<Output::PointResults> collect_results(Method &method, const Scene<dim> &scene,
                                                        const OutputSettings &output);
} // namespace Stroma
