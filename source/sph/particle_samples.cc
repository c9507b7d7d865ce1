// Values of ParticleMethod at any place, for comparisons.

#include "particle_sampler.h"

#include <stroma/output/collective.h>
#include <stroma/sph/particle_method.h>

namespace Stroma::Sph
{
  namespace
  {
    template <int dim>
    dealii::Point<dim>
    point_of(const std::array<double, 3> &X)
    {
      dealii::Point<dim> point;
      for (unsigned int d = 0; d < dim; ++d)
        point[d] = X[d];
      return point;
    }
  } // namespace

  template <int dim>
  std::vector<SampledField>
  ParticleMethod<dim>::sampled_fields() const
  {
    std::vector<SampledField> fields;
    for (const auto &field : sample_table<dim>(scene))
      fields.push_back({ field.full_name(), field.components });
    return fields;
  }

  /// Each rank evaluates its share of the places.
  template <int dim>
  void
  ParticleMethod<dim>::sample(const std::vector<std::string> &names, Samples &samples)
  {
    const auto                 fields = Output::with_full_names(sample_table(scene), names);
    const std::size_t          n = samples.X.size(), width = n_components(fields);
    const std::size_t          rank    = dealii::Utilities::MPI::this_mpi_process(scene.comm);
    const std::size_t          n_ranks = dealii::Utilities::MPI::n_mpi_processes(scene.comm);
    const ParticleSampler<dim> sampler(*system, time);
    std::vector<unsigned int>  found(n, 0);
    samples.values.assign(n * width, 0.);
    ParticleState<dim> state;
    for (std::size_t i = rank; i < n; i += n_ranks)
    {
      found[i] = sampler.state_at(point_of<dim>(samples.X[i]), state);
      if (found[i])
        fill(fields, state, samples.values.data() + i * width);
    }
    dealii::Utilities::MPI::sum(samples.values, scene.comm, samples.values);
    dealii::Utilities::MPI::sum(found, scene.comm, found);
    samples.found.assign(found.begin(), found.end());
  }

  template <int dim>
  Samples
  ParticleMethod<dim>::own_samples(const std::vector<std::string> &names)
  {
    const auto         fields      = Output::with_full_names(sample_table(scene), names);
    const unsigned int width       = n_components(fields);
    const bool         is_gradient = std::any_of(
                fields.begin(), fields.end(),
                [](const auto &field) { return field.name == "displacement_gradient" || field.name == "velocity_gradient"; });
    std::unique_ptr<ParticleSampler<dim>> sampler;
    if (is_gradient)
      sampler = std::make_unique<ParticleSampler<dim>>(*system, time);
    const StateReader<dim> state_of(*system);
    const unsigned int     n = system->particles.n_free;
    Samples                mine, all;
    mine.values.resize(n * width);
    for (unsigned int i = 0; i < n; ++i)
    {
      auto state = state_of(i);
      if (sampler)
        sampler->set_gradients(i, state);
      const auto place = ParticleSampler<dim>::place_of(*system, i);
      mine.X.push_back({});
      std::copy(place.begin_raw(), place.end_raw(), mine.X.back().begin());
      mine.weight.push_back(state.V0);
      mine.material.push_back(state.material);
      fill(fields, state, mine.values.data() + i * width);
    }
    all.X        = Output::gather_all(mine.X, scene.comm);
    all.weight   = Output::gather_all(mine.weight, scene.comm);
    all.material = Output::gather_all(mine.material, scene.comm);
    all.values   = Output::gather_all(mine.values, scene.comm);
    return all;
  }

  template class ParticleMethod<2>;
  template class ParticleMethod<3>;
} // namespace Stroma::Sph
