// Sizes and parts of ParticleMethod.

#include <stroma/sph/particle_method.h>

#include <deal.II/base/mpi.h>

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
      return bytes + system.neighbours->neighbour.size() * sizeof(unsigned int) +
             pairs.n_pairs() * (sizeof(pairs.j[0]) + sizeof(pairs.r[0]) + sizeof(pairs.c[0]) + sizeof(pairs.P[0]) +
                                sizeof(pairs.friction[0]) + (system.friction ? sizeof(double) : 0));
    }
  } // namespace

  template <int dim>
  void
  ParticleMethod<dim>::describe(Output::Summary &summary)
  {
    summary.dimension       = dim;
    summary.n_points        = system->n_free + system->n_fixed;
    summary.n_dofs          = dim * system->n_free;
    summary.laws            = scene.laws_in_words();
    summary.bytes_per_point = double(dealii::Utilities::MPI::sum(std::uint64_t(bytes_of(*system)), scene.comm)) /
                              summary.n_points;
    describe_parts(summary);
    describe_stepping(summary);
  }

  template <int dim>
  void
  ParticleMethod<dim>::describe_parts(Output::Summary &summary) const
  {
    const auto part = [&](const bool is_used, const std::string &name) {
      (is_used ? summary.used : summary.left_out).push_back(name);
    };
    // Read off what is there, not off the settings.
    const auto   used = used_fields();
    unsigned int f    = 0;
    system->particles.visit_fields(
      [&](const char *name, const auto &) { part(used[f++], std::string("point field: ") + name); });
    const bool has_ghosts = system->particles.size() > system->particles.n_owned;
    part(system->n_fixed > 0, "fixed particles");
    part(system->pairs.has_facets(), "walls of facets");
    part(system->loads->holds_any(), "held particles");
    part(dealii::Utilities::MPI::max(static_cast<unsigned int>(has_ghosts), scene.comm) > 0, "ghost particles");
    part(std::any_of(scene.periodic.begin(), scene.periodic.end(), [](const bool p) { return p; }), "periodic images");
    part(system->area_vectors != nullptr, "closed area vectors");
    part(system->contacts != nullptr, "contact");
    part(system->degraded != nullptr, "degradation");
    part(system->packing != nullptr, "shifts of crowded particles");
    part(system->friction != nullptr, "friction of pairs");
    part(system->is_smooth, "friction of velocity gradients");
    part(system->hourglass_control != nullptr, "hourglass control");
    part(system->interfaces != nullptr, "interfaces between materials");
    part(dynamics == Dynamics::inertial, "inertia");
    part(false, "grid");
  }

  template class ParticleMethod<2>;
  template class ParticleMethod<3>;
} // namespace Stroma::Sph
