#pragma once

#include <stroma/output/collective.h>
#include <stroma/simulation/method.h>

namespace Stroma
{
  /// The committed state's values at places @p X, which every rank asks for.
  inline Output::Samples
  sampled(Method &method, const unsigned int dim, const std::vector<std::string> &fields,
          const std::vector<Output::Place> &X)
  {
    Output::Samples samples;
    samples.X = X;
    method.state(true)->sample({dim, fields}, samples);
    return samples;
  }

  /// The sample points of all ranks with their values.
  inline Output::Samples
  all_own_samples(Method &method, const unsigned int dim, const std::vector<std::string> &fields)
  {
    const auto mine = Output::own_samples(*method.state(true), {dim, fields});
    const auto comm = MPI_COMM_WORLD;
    return {Output::gather_all(mine.X, comm),
            Output::gather_all(mine.weight, comm),
            Output::gather_all(mine.material, comm),
            Output::gather_all(mine.values, comm),
            {}};
  }
} // namespace Stroma
