#pragma once

#include <stroma/base/resource_use.h>
#include <stroma/output/point_results.h>
#include <stroma/simulation/problem.h>
#include <stroma/simulation/run_state.h>

namespace Stroma
{
  /// All of the summary of a run of @p file that has come @p so_far, but its status: what the method, the points, the specimen
  /// and the images tell, and what it cost. @p collected: results of the points, where they are known already. Collective.
  /// Returns the histograms that the scene asks for.
  template <int dim>
  std::vector<Output::Histogram> complete(Output::Summary &summary, const Problem<dim> &problem, const RunState &so_far,
                                          const ParameterFile &file, const Output::PointResults *collected,
                                          Timers &timers, const ResourceUse &use, MPI_Comm comm);
} // namespace Stroma
