#include <stroma/base/log.h>
#include <stroma/output/collective.h>
#include <stroma/particles/arrangement.h>
#include <stroma/scene/consistency.h>
#include <stroma/sph/loads.h>

#include <deal.II/base/mpi.h>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    template <int dim>
    bool
    holds_material(const Support<dim> &support)
    {
      return !support.region.is_boundary() && support.region.kind != Region<dim>::Kind::body;
    }
  } // namespace

  template <int dim>
  Loads<dim>::Loads(const Scene<dim> &scene, const ParticleSet<dim> &particles, const double spacing,
                    const double end_time)
    : densities(scene)
    , scene(scene)
    , box(scene.bounding_box())
    , spacing(spacing)
  {
    using Kind = typename Region<dim>::Kind;
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      {
        const auto &region = scene.loads[l].region;
        nearest_loaded.push_back(region.kind == Kind::nearest ? nearest(region, particles) : 0);
        changes |= densities.depends_on_time(l) || (scene.is_fluid() && densities.depends_on_place(l));
        if (region.kind == Kind::body)
          continue;
        measure(l, found(l, particles, particles.X));
        densities.require(l, "particle");
      }
    for (const auto &support : scene.supports)
      nearest_held.push_back(support.region.kind == Kind::nearest ? nearest(support.region, particles) : 0);
    find(particles);
    check_overlaps(particles, end_time);
    std::vector<unsigned int> count(scene.supports.size());
    for (unsigned int s = 0; s < count.size(); ++s)
      for (unsigned int i = 0; holds_material(scene.supports[s]) && i < particles.n_free; ++i)
        count[s] += is_on(scene.supports[s].region, s, particles, i);
    dealii::Utilities::MPI::sum(count, scene.comm, count);
    for (unsigned int s = 0; s < count.size(); ++s)
      if (holds_material(scene.supports[s]) && count[s] == 0)
        throw UserError(scene.supports[s].where, "support '" + scene.supports[s].name + "' holds no particle");
    any_held = dealii::Utilities::MPI::max(held_particles.empty() ? 0 : 1, scene.comm) > 0;
  }

  template <int dim>
  std::uint64_t
  Loads<dim>::nearest(const Region<dim> &region, const ParticleSet<dim> &particles) const
  {
    std::pair<double, std::uint64_t> best = {std::numeric_limits<double>::max(), 0};
    for (unsigned int i = 0; i < particles.n_free; ++i)
      best = std::min(best, std::make_pair(particles.X[i].distance(region.first), particles.id[i]));
    for (const auto &other : dealii::Utilities::MPI::all_gather(scene.comm, best))
      best = std::min(best, other);
    return best.second;
  }

  template <int dim>
  std::vector<typename Loads<dim>::Share>
  Loads<dim>::found(const unsigned int load, const ParticleSet<dim> &particles,
                    const std::vector<dealii::Point<dim>> &places) const
  {
    const auto        &region = scene.loads[load].region;
    std::vector<Share> found;
    if (region.kind == Region<dim>::Kind::body)
      return found;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      {
        const double share = region.kind == Region<dim>::Kind::nearest ?
                               particles.id[i] == nearest_loaded[load] :
                               share_in_region(scene, region, places[i], particles.material_of(i), spacing);
        if (share > 0.)
          found.push_back({i, share * particles.V0[i]});
      }
    return found;
  }

  template <int dim>
  void
  Loads<dim>::measure(const unsigned int load, const std::vector<Share> &shares)
  {
    double volume = 0.;
    for (const Share &share : shares)
      volume += share.volume;
    densities.measure(load, volume * (dim == 2 ? scene.thickness : 1.));
  }

  template <int dim>
  bool
  Loads<dim>::is_on(const Region<dim> &region, const unsigned int index, const ParticleSet<dim> &particles,
                    const unsigned int i) const
  {
    if (region.kind == Region<dim>::Kind::nearest)
      return particles.id[i] == nearest_held[index];
    return region.contains(particles.X[i], particles.material_of(i), box);
  }

  template <int dim>
  void
  Loads<dim>::find(const ParticleSet<dim> &particles)
  {
    force_time = std::nan("");
    loaded.clear();
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      {
        loaded.push_back(found(l, particles, scene.is_fluid() ? particles.x_search : particles.X));
        if (!scene.is_fluid() || !scene.loads[l].total.given())
          continue;
        const double before = densities.measures()[l];
        measure(l, loaded[l]);
        if (before > 0. && densities.measures()[l] == 0.)
          Log::warning(scene.loads[l].where + ": no particle is left where load '" + scene.loads[l].name +
                       "' acts, and its total force acts on nothing until one comes back");
      }

    held_particles.clear();
    mask.clear();
    for (unsigned int s = 0; s < scene.supports.size(); ++s)
      {
        const auto &support = scene.supports[s];
        if (!holds_material(support))
          continue;
        mask.resize(particles.n_free);
        for (unsigned int i = 0; i < particles.n_free; ++i)
          if (is_on(support.region, s, particles, i))
            {
              std::uint8_t components = 0;
              for (unsigned int c = 0; c < dim; ++c)
                components |= support.holds(c) << c;
              components &= ~mask[i];
              if (components == 0)
                continue;
              held_particles.push_back({i, s, components});
              mask[i] |= components;
            }
      }
  }

  template <int dim>
  void
  Loads<dim>::check_overlaps(const ParticleSet<dim> &particles, const double end_time) const
  {
    std::string contradiction;
    for (const Held &first : held_particles)
      for (unsigned int s = first.support + 1; s < scene.supports.size() && contradiction.empty(); ++s)
        if (const auto &other = scene.supports[s];
            holds_material(other) && is_on(other.region, s, particles, first.particle))
          for (unsigned int c = 0; c < dim && contradiction.empty(); ++c)
            if (first.holds(c) && other.holds(c))
              try
                {
                  check_agreement(scene, {first.support, particles.X[first.particle]}, {s, particles.X[first.particle]},
                                  c, end_time);
                }
              catch (const UserError &error)
                {
                  contradiction = error.what();
                }
    Output::throw_if_any(contradiction, scene.comm);
  }

  template <int dim>
  const std::vector<Tensor<1, dim>> &
  Loads<dim>::force(const ParticleSet<dim> &particles, const double t)
  {
    if ((force_time == t && !scene.is_fluid()) || (!changes && !std::isnan(force_time)))
      return forces;
    force_time         = t;
    const auto &places = scene.is_fluid() ? particles.x : particles.X;
    forces.assign(particles.n_free, {});
    for (unsigned int l = 0; l < scene.loads.size(); ++l)
      for (const Share &share : loaded[l])
        forces[share.particle] += densities.value(l, places[share.particle], t) * share.volume;
    return forces;
  }

  template <int dim>
  Tensor<1, dim>
  Loads<dim>::velocity(const Held &held, const ParticleSet<dim> &particles, const double t, const double t_next) const
  {
    const auto &support = scene.supports[held.support];
    const auto &X       = particles.X[held.particle];
    if (support.velocity.given())
      return support.velocity.value(X, t_next);
    return (support.displacement.value(X, t_next) - support.displacement.value(X, t)) / (t_next - t);
  }

  template class Loads<2>;
  template class Loads<3>;
} // namespace Stroma::Sph
