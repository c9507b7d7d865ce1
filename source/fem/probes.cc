#include <stroma/fem/probes.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Fem
{
  template <int dim>
  Probes<dim>::Probes(const std::vector<Probe<dim>> &probes, const Unknowns<dim> &unknowns, const double grain,
                      const MPI_Comm comm)
    : comm(comm)
  {
    if (probes.empty())
      return;
    const auto nodes = unknowns.owned_nodes();
    for (const auto &probe : probes)
      {
        using Key      = std::array<double, 4>; // distance in grains, coordinates
        const auto key = [&](const dealii::Point<dim> &X) {
          Key result{{std::round(X.distance(probe.place) / grain), 0., 0., 0.}};
          for (unsigned int d = 0; d < dim; ++d)
            result[1 + d] = X[d];
          return result;
        };
        Key best{{std::numeric_limits<double>::max(), 0., 0., 0.}};
        for (const auto &node : nodes)
          best = std::min(best, key(node.X));
        const auto all     = dealii::Utilities::MPI::all_gather(comm, best);
        const auto nearest = *std::min_element(all.begin(), all.end());
        for (unsigned int c = 0; c < dim; ++c)
          {
            watched.push_back({"displacement_" + probe.name + "_" + "xyz"[c] + "_m", dealii::numbers::invalid_dof_index});
            for (const auto &node : nodes)
              if (node.component == c && key(node.X) == nearest)
                watched.back().dof = node.dof;
          }
      }
  }

  template <int dim>
  std::vector<std::pair<std::string, double>>
  Probes<dim>::scalars(const Vector &u) const
  {
    std::vector<double> values;
    for (const auto &one : watched)
      values.push_back(one.dof == dealii::numbers::invalid_dof_index ? 0. : u(one.dof));
    dealii::Utilities::MPI::sum(values, comm, values);
    std::vector<std::pair<std::string, double>> named;
    for (std::size_t i = 0; i < watched.size(); ++i)
      named.emplace_back(watched[i].name, values[i]);
    return named;
  }

  template class Probes<2>;
  template class Probes<3>;
} // namespace Stroma::Fem
