// Fields and results of ParticleMethod.

#include "particle_sampler.h"

#include <stroma/output/statistics.h>
#include <stroma/sph/particle_method.h>

#include <cmath>

namespace Stroma::Sph
{
  namespace
  {
    /// The fields of this rank's particles, ghosts included, and its lists of pairs; not the vectors of a solver.
    template <int dim>
    std::size_t
    bytes_of(System<dim> &system)
    {
      std::size_t bytes = 0;
      system.particles.visit_fields([&](const char *, const auto &field) { bytes += field.size() * sizeof(field[0]); });
      const auto &pairs = system.pairs;
      return bytes + system.neighbours->neighbour.size() * sizeof(unsigned int)
             + pairs.n_pairs()
                   * (sizeof(pairs.j[0]) + sizeof(pairs.r[0]) + sizeof(pairs.c[0]) + sizeof(pairs.P[0])
                      + sizeof(pairs.friction[0]) + (system.friction ? sizeof(double) : 0));
    }
  } // namespace

  template <int dim>
  std::vector<std::string>
  ParticleMethod<dim>::known_point_fields() const
  {
    std::vector<std::string> names;
    for (const auto &field : point_fields<dim>(scene))
      names.push_back(field.name);
    return names;
  }

  template <int dim>
  std::vector<std::pair<std::string, std::string>>
  ParticleMethod<dim>::write_fields(const FieldRequest &request)
  {
    const auto                   scope = timers.scope("field files");
    const auto                 chosen = Output::named(point_fields<dim>(scene), request.point_fields);
    std::vector<Output::Field> fields;
    for (const auto &field : chosen)
      fields.push_back({ field.full_name(), field.components });
    if (chosen.empty())
      return {};
    Output::PointWriter<dim> writer(request.folder, "points", request.counter, fields, scene.comm, request.format);
    std::vector<double>      values(n_components(chosen));
    const StateReader<dim>   state_of(*system);
    for (unsigned int i = 0; i < system->particles.n_owned; ++i)
    {
      fill(chosen, state_of(i), values.data());
      writer.add(system->particles.x[i], dealii::make_array_view(values));
    }
    return { { "points", writer.close() } };
  }

  template <int dim>
  void
  ParticleMethod<dim>::describe(Output::Summary &summary)
  {
    summary.dimension = dim;
    summary.n_points  = system->n_free + system->n_fixed;
    summary.n_dofs    = dim * system->n_free;
    summary.laws      = scene.laws_in_words();
    summary.bytes_per_point
        = double(dealii::Utilities::MPI::sum(std::uint64_t(bytes_of(*system)), scene.comm)) / summary.n_points;
    for (const auto &[name, value] : committed_scalars)
      summary.results[name] = value;
    describe_parts(summary);
    describe_stepping(summary);
    const auto scope = timers.scope("results");
    stress_results(summary);
    error_results(summary);
  }

  template <int dim>
  void
  ParticleMethod<dim>::describe_parts(Output::Summary &summary) const
  {
    const auto part = [&](const bool is_used, const std::string &name)
    { (is_used ? summary.used : summary.left_out).push_back(name); };
    // Read off what is there, not off the settings.
    const auto   used = used_fields();
    unsigned int f    = 0;
    system->particles.visit_fields([&](const char *name, const auto &)
                                   { part(used[f++], std::string("point field: ") + name); });
    const bool has_ghosts = system->particles.size() > system->particles.n_owned;
    part(system->n_fixed > 0, "fixed particles");
    part(system->loads->holds_any(), "held particles");
    part(dealii::Utilities::MPI::max(static_cast<unsigned int>(has_ghosts), scene.comm) > 0, "ghost particles");
    part(std::any_of(scene.periodic.begin(), scene.periodic.end(), [](const bool p) { return p; }), "periodic images");
    part(system->area_vectors != nullptr, "closed area vectors");
    part(system->packing != nullptr, "shifts of crowded particles");
    part(system->friction != nullptr, "friction of pairs");
    part(system->is_smooth, "friction of velocity gradients");
    part(system->holds_grid_modes(), "held grid-scale modes");
    part(dynamics == Dynamics::inertial, "inertia");
    part(false, "grid");
  }

  template <int dim>
  void
  ParticleMethod<dim>::stress_results(Output::Summary &summary) const
  {
    const StateReader<dim>          state_of(*system);
    Output::VolumeWeightedQuantiles quantiles;
    quantiles.reserve(system->particles.n_free);
    for (unsigned int i = 0; i < system->particles.n_free; ++i)
    {
      const auto state = state_of(i);
      quantiles.add(Solid::von_mises(state.cauchy), state.V0);
    }
    Output::von_mises_results(quantiles, scene.comm, summary.results);
  }

  template <int dim>
  void
  ParticleMethod<dim>::error_results(Output::Summary &summary) const
  {
    if (system->has_solids() && scene.exact_displacement.given())
      vector_error("displacement", scene.exact_displacement, summary);
    if (scene.exact_velocity.given())
      vector_error("velocity", scene.exact_velocity, summary);
    if (!scene.exact_pressure.given())
      return;
    std::vector<double>    sums(2); // (p - exact)^2 V, exact^2 V
    const StateReader<dim> state_of(*system);
    for (unsigned int i = 0; i < system->particles.n_free; ++i)
    {
      const auto   state = state_of(i);
      const double exact = scene.exact_pressure.value(ParticleSampler<dim>::place_of(*system, i), time)[0];
      sums[0] += state.V0 * std::pow(state.pressure - exact, 2);
      sums[1] += state.V0 * exact * exact;
    }
    dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    summary.results["pressure_error_L2_relative"] = std::sqrt(sums[0] / sums[1]);
  }

  /// Relative errors of the values and gradients of displacement or velocity, sums over the free particles.
  template <int dim>
  void
  ParticleMethod<dim>::vector_error(const std::string &name, const SpaceTimeVector<dim> &solution,
                                    Output::Summary &summary) const
  {
    const bool                 of_displacement = name == "displacement";
    const ParticleSampler<dim> sampler(*system, time);
    const StateReader<dim>     state_of(*system);
    const double               step = 1e-4 * settings.arrangement.spacing;
    std::vector<double>        sums(4); // |error|^2 V, |exact|^2 V, and the same of the gradients
    for (unsigned int i = 0; i < system->particles.n_free; ++i)
    {
      auto state = state_of(i);
      sampler.set_gradients(i, state);
      const auto  place    = ParticleSampler<dim>::place_of(*system, i);
      const auto  exact    = solution.value(place, time);
      const auto &gradient = of_displacement ? state.u_gradient : state.v_gradient;
      sums[0] += state.V0 * ((of_displacement ? state.u : state.v) - exact).norm_square();
      sums[1] += state.V0 * exact.norm_square();
      for (unsigned int k = 0; k < dim; ++k)
      {
        const auto d = dealii::Point<dim>::unit_vector(k) * step;
        const auto slope
            = (solution.value(place + d, time) - solution.value(dealii::Point<dim>(place - d), time)) / (2. * step);
        for (unsigned int c = 0; c < dim; ++c)
          sums[2] += state.V0 * std::pow(gradient[c][k] - slope[c], 2);
        sums[3] += state.V0 * slope.norm_square();
      }
    }
    dealii::Utilities::MPI::sum(sums, scene.comm, sums);
    summary.results[name + "_error_L2_relative"] = std::sqrt(sums[0] / sums[1]);
    summary.results[name + "_error_H1_relative"] = std::sqrt(sums[2] / sums[3]);
  }

  template class ParticleMethod<2>;
  template class ParticleMethod<3>;
} // namespace Stroma::Sph
