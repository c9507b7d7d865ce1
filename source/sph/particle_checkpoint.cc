// Saving and continuing ParticleMethod.

#include <stroma/output/collective.h>
#include <stroma/sph/particle_method.h>

#include <cstring>
#include <numeric>
#include <type_traits>

namespace Stroma::Sph
{
  namespace
  {
    std::string
    name_in_archive(const char *field)
    {
      return std::string("particles/") + field;
    }

    template <typename T>
    void
    write_field(Output::ArchiveWriter &archive, const std::string &name, const std::vector<T> &field,
                const unsigned int n)
    {
      if constexpr (std::is_integral_v<T>)
        {
          const std::vector<std::uint64_t> numbers(field.begin(), field.begin() + n);
          archive.write(name, dealii::make_array_view(numbers));
        }
      else
        archive.write(name, dealii::ArrayView<const double>(reinterpret_cast<const double *>(field.data()),
                                                            n * sizeof(T) / sizeof(double)));
    }

    /// This rank's block; on other ranks than those that wrote, its share of all particles, a contiguous one.
    template <typename T>
    void
    read_field(const Output::ArchiveReader &archive, const std::string &name, std::vector<T> &field)
    {
      if constexpr (std::is_integral_v<T>)
        {
          const auto numbers = archive.read_uint64(name);
          field.assign(numbers.begin(), numbers.end());
        }
      else
        {
          constexpr unsigned int width   = sizeof(T) / sizeof(double);
          const auto             numbers = archive.read_double(name, width);
          field.resize(numbers.size() / width);
          if (!field.empty())
            std::memcpy(static_cast<void *>(field.data()), numbers.data(), numbers.size() * sizeof(double));
        }
    }

    template <int dim>
    std::vector<double>
    numbers_of(const std::vector<Rigid::Pose<dim>> &poses)
    {
      std::vector<double> numbers;
      for (const auto &pose : poses)
        {
          numbers.insert(numbers.end(), pose.translation.begin_raw(), pose.translation.end_raw());
          numbers.insert(numbers.end(), pose.rotation.begin_raw(), pose.rotation.end_raw());
        }
      return numbers;
    }

    template <int dim>
    void
    set_numbers(const double *numbers, Rigid::Pose<dim> &pose)
    {
      std::copy_n(numbers, dim, pose.translation.begin_raw());
      std::copy_n(numbers + dim, Rigid::n_rotations<dim>, pose.rotation.begin_raw());
    }

    /// Free particles first, each part in the order that it has.
    template <int dim>
    void
    sort_free_first(ParticleSet<dim> &particles)
    {
      std::vector<unsigned int> order(particles.size());
      std::iota(order.begin(), order.end(), 0u);
      const auto first_fixed = std::stable_partition(order.begin(), order.end(),
                                                     [&](const unsigned int i) { return !particles.is_fixed(i); });
      particles.n_free       = static_cast<unsigned int>(first_fixed - order.begin());
      particles.n_owned      = particles.size();
      particles.visit_fields([&](const char *, auto &field) {
        auto sorted = field;
        for (unsigned int i = 0; i < field.size(); ++i)
          sorted[i] = field[order[i]];
        field = std::move(sorted);
      });
    }
  } // namespace

  template <int dim>
  void
  ParticleMethod<dim>::save(Output::ArchiveWriter &archive) const
  {
    auto        &particles = system->particles;
    const auto   used      = used_fields();
    unsigned int f         = 0;
    particles.visit_fields([&](const char *name, const auto &field) {
      if (used[f++])
        write_field(archive, name_in_archive(name), field, particles.n_owned);
    });

    const bool is_root  = dealii::Utilities::MPI::this_mpi_process(scene.comm) == 0;
    const auto measures = system->loads->densities.measures();
    write_field(archive, "load_measures", measures, is_root ? measures.size() : 0);
    auto       poses = numbers_of(system->poses_before());
    const auto then  = numbers_of(system->pairs_poses);
    poses.insert(poses.end(), then.begin(), then.end());
    write_field(archive, "poses", poses, is_root ? poses.size() : 0);
    const auto bodies = system->body_motions();
    write_field(archive, "body_motions", bodies, is_root ? bodies.size() : 0);
    archive.attribute("step_start", system->step_start());
    archive.attribute("pairs_time", system->pairs_time);
    archive.attribute("drawn_at", system->drawn_at);
    archive.attribute("rebuilds_in_order", std::uint64_t(system->neighbours->n_in_order()));
  }

  /// Whether some rank has it, for each field in the order of Particles. Collective.
  template <int dim>
  std::vector<unsigned int>
  ParticleMethod<dim>::used_fields() const
  {
    std::vector<unsigned int> used;
    system->particles.visit_fields([&](const char *, const auto &field) { used.push_back(!field.empty()); });
    dealii::Utilities::MPI::max(used, scene.comm, used);
    return used;
  }

  /// Whether the particles are in the order that they had.
  template <int dim>
  bool
  ParticleMethod<dim>::restore(const Output::ArchiveReader &archive)
  {
    ParticleSet<dim> owned;
    owned.contact_gaps.resize(scene.contacts.size());
    owned.visit_fields([&](const char *name, auto &field) {
      if (archive.has(name_in_archive(name)))
        read_field(archive, name_in_archive(name), field);
    });
    sort_free_first(owned);
    system->restore(std::move(owned));
    system->now      = time;
    system->drawn_at = archive.attribute_double("drawn_at");
    restore_bodies(archive);
    system->restore_step(archive.attribute_double("step_start"), time,
                         Output::gather_all(archive.read_double("body_motions"), scene.comm));
    system->loads->densities.set_measures(Output::gather_all(archive.read_double("load_measures"), scene.comm));
    const bool has_pairs = archive.has(name_in_archive("place of pairs"));
    if (has_pairs)
      system->restore_pairs(archive.attribute_double("pairs_time"), archive.attribute_uint64("rebuilds_in_order"));
    else
      find_geometry();
    return has_pairs && archive.is_same_ranks();
  }

  template <int dim>
  void
  ParticleMethod<dim>::restore_bodies(const Output::ArchiveReader &archive)
  {
    const auto             poses = Output::gather_all(archive.read_double("poses"), scene.comm);
    constexpr unsigned int width = dim + Rigid::n_rotations<dim>;
    const unsigned int     n     = system->movers.size();
    for (unsigned int m = 0; m < n; ++m)
      {
        set_numbers(&poses[width * m], system->poses[m]);
        set_numbers(&poses[width * (n + m)], system->pairs_poses[m]);
      }
  }

  template class ParticleMethod<2>;
  template class ParticleMethod<3>;
} // namespace Stroma::Sph
