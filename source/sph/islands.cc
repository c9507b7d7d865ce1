#include "islands.h"

#include <stroma/base/disjoint_sets.h>

namespace Stroma::Sph
{
  namespace
  {
    /// Whether mover @p m is a rigid body that the balance of forces moves.
    template <int dim>
    bool
    is_free(const System<dim> &system, const unsigned int m)
    {
      return system.bodies && system.bodies->moves(m);
    }

    /// Takes anchors over from particles to the free bodies that they touch, and back. Collective.
    template <int dim>
    void
    share_with_bodies(const System<dim> &system, std::vector<std::uint8_t> &anchored, std::vector<std::uint8_t> &bodies)
    {
      const auto &pairs          = system.pairs;
      const auto  for_free_pairs = [&](const auto &visit) {
        for (unsigned int i = 0; i < system.particles.n_free; ++i)
          for (unsigned int p = pairs.row_fixed[i]; p < pairs.row_start[i + 1]; ++p)
            if (is_free(system, system.mover_of(p)))
              visit(i, system.mover_of(p));
      };
      for_free_pairs([&](const unsigned int i, const unsigned int m) { bodies[m] |= anchored[i]; });
      std::vector<unsigned int> of_all(bodies.begin(), bodies.end());
      dealii::Utilities::MPI::max(of_all, system.scene.comm, of_all);
      std::copy(of_all.begin(), of_all.end(), bodies.begin());
      for_free_pairs([&](const unsigned int i, const unsigned int m) { anchored[i] |= bodies[m]; });
    }

    /// Whether each particle, ghosts included, is held itself or ends at a wall that moves as given.
    template <int dim>
    std::vector<std::uint8_t>
    anchors(const System<dim> &system)
    {
      const auto               &particles = system.particles;
      std::vector<std::uint8_t> anchored(particles.size());
      for (unsigned int i = 0; i < particles.n_free; ++i)
        for (unsigned int p = system.pairs.row_fixed[i]; p < system.pairs.row_start[i + 1]; ++p)
          anchored[i] |= !is_free(system, system.mover_of(p));
      for (const auto &held : system.loads->held())
        anchored[held.particle] = 1;
      if (!system.is_supported())
        {
          std::uint64_t lowest = std::numeric_limits<std::uint64_t>::max();
          for (unsigned int i = 0; i < particles.n_free; ++i)
            lowest = std::min(lowest, particles.id[i]);
          lowest = dealii::Utilities::MPI::min(lowest, system.scene.comm);
          for (unsigned int i = 0; i < particles.n_free; ++i)
            anchored[i] = particles.id[i] == lowest;
        }
      return anchored;
    }
  } // namespace

  template <int dim>
  Islands<dim>
  find_islands(const System<dim> &system)
  {
    const auto        &particles = system.particles;
    const auto        &pairs     = system.pairs;
    const auto         comm      = system.scene.comm;
    const unsigned int n         = particles.n_free;
    DisjointSets       sets(particles.size());
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        sets.unite(i, pairs.j[p]);

    // What is anchored on one rank anchors the set on all: told until nothing is news.
    auto                      anchored = anchors(system);
    std::vector<std::uint8_t> bodies(system.movers.size());
    for (unsigned int m = 0; m < bodies.size(); ++m)
      bodies[m] = is_free(system, m) && system.bodies->resists(m);
    for (bool news = true; news;)
      {
        const auto before = anchored;
        if (system.bodies)
          share_with_bodies(system, anchored, bodies);
        news = anchored != before;
        system.neighbours->update_ghosts(anchored);
        std::vector<std::uint8_t> of_root(particles.size());
        for (unsigned int i = 0; i < particles.size(); ++i)
          of_root[sets.root(i)] |= anchored[i];
        for (unsigned int i = 0; i < n; ++i)
          if (!anchored[i] && of_root[sets.root(i)])
            anchored[i] = news = true;
        news = dealii::Utilities::MPI::max(news ? 1 : 0, comm) == 1;
      }

    Islands<dim> islands;
    for (unsigned int m = 0; m < bodies.size() && islands.body.empty(); ++m)
      if (is_free(system, m) && !bodies[m])
        islands.body = system.movers[m].name;
    std::pair<std::uint64_t, dealii::Point<dim>> lowest{std::numeric_limits<std::uint64_t>::max(), {}};
    for (unsigned int i = 0; i < n; ++i)
      if (!anchored[i])
        {
          ++islands.n_particles;
          if (particles.id[i] < lowest.first)
            lowest = {particles.id[i], particles.X[i]};
        }
    islands.n_particles = dealii::Utilities::MPI::sum(islands.n_particles, comm);
    if (islands.n_particles > 0)
      {
        for (const auto &other : dealii::Utilities::MPI::all_gather(comm, lowest))
          if (other.first < lowest.first)
            lowest = other;
        islands.X = lowest.second;
      }
    return islands;
  }

  template Islands<2> find_islands(const System<2> &);
  template Islands<3> find_islands(const System<3> &);
} // namespace Stroma::Sph
