#include <stroma/base/errors.h>
#include <stroma/simulation/probes.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma
{
  template <int dim>
  Probes<dim>::Probes(std::vector<Probe<dim>> probes, const MPI_Comm comm)
    : probes(std::move(probes))
    , comm(comm)
  {}

  template <int dim>
  Scalars
  Probes<dim>::scalars(Method &method) const
  {
    if (probes.empty())
      return {};
    const auto &known           = method.facts.sampled_fields;
    const bool  is_displacement = std::find(known.begin(), known.end(), "displacement") != known.end();
    // Rank 0 asks and tells the others.
    const bool      is_root = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
    Output::Samples samples;
    for (const auto &probe : probes)
      if (is_root)
        samples.X.push_back(Output::place_of<dim>(probe.place));
    method.state(false)->sample({dim, {is_displacement ? "displacement" : "velocity"}}, samples);
    const auto values = dealii::Utilities::MPI::broadcast(comm, samples.values, 0);
    const auto found  = dealii::Utilities::MPI::broadcast(comm, samples.found, 0);
    Scalars    named;
    for (std::size_t i = 0; i < probes.size(); ++i)
      {
        if (!found[i])
          throw UserError(probes[i].where,
                          "there is no material at the probe '" + probes[i].name +
                            "'; move it into a body, or away from an edge that the grid does not follow");
        for (unsigned int c = 0; c < dim; ++c)
          named.emplace_back((is_displacement ? "displacement_" : "velocity_") + probes[i].name + "_" + "xyz"[c] +
                               (is_displacement ? "_m" : "_m_per_s"),
                             values[i * dim + c]);
      }
    return named;
  }

  template class Probes<2>;
  template class Probes<3>;
} // namespace Stroma
