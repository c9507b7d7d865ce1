#include <stroma/base/errors.h>
#include <stroma/simulation/probes.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    bool
    has_displacement(const Method &method)
    {
      const auto fields = method.sampled_fields();
      return std::any_of(fields.begin(), fields.end(), [](const auto &field) { return field.name == "displacement_m"; });
    }
  } // namespace

  template <int dim>
  Probes<dim>::Probes(std::vector<Probe<dim>> probes)
    : probes(std::move(probes))
  {}

  template <int dim>
  std::vector<std::pair<std::string, double>>
  Probes<dim>::scalars(Method &method) const
  {
    if (probes.empty())
      return {};
    const bool is_displacement = has_displacement(method);
    Samples    samples;
    for (const auto &probe : probes)
      {
        samples.X.push_back({});
        std::copy_n(probe.place.begin_raw(), dim, samples.X.back().begin());
      }
    method.sample({is_displacement ? "displacement_m" : "velocity_m_per_s"}, samples);
    std::vector<std::pair<std::string, double>> named;
    for (std::size_t i = 0; i < probes.size(); ++i)
      {
        if (!samples.found.empty() && !samples.found[i])
          throw UserError(probes[i].where, "there is no material at the probe '" + probes[i].name +
                                             "'; move it into a body, or away from an edge that the grid does not follow");
        for (unsigned int c = 0; c < dim; ++c)
          named.emplace_back((is_displacement ? "displacement_" : "velocity_") + probes[i].name + "_" + "xyz"[c] +
                               (is_displacement ? "_m" : "_m_per_s"),
                             samples.values[i * dim + c]);
      }
    return named;
  }

  template class Probes<2>;
  template class Probes<3>;
} // namespace Stroma
