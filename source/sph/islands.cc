#include <stroma/base/disjoint_sets.h>
#include <stroma/sph/islands.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>

namespace Stroma::Sph
{
  using dealii::Tensor;

  namespace
  {
    constexpr std::uint64_t no_label = std::numeric_limits<std::uint64_t>::max();

    /// Whether mover @p m is a rigid body that the balance of forces moves.
    template <int dim>
    bool
    is_free(const System<dim> &system, const unsigned int m)
    {
      return system.bodies && system.bodies->moves(m);
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
          std::uint64_t lowest = no_label;
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
  struct Islands<dim>::Search
  {
    std::vector<std::uint8_t>          anchored; ///< each particle, ghosts included
    std::vector<std::uint8_t>          bodies;   ///< whether the free ones are anchored, by mover
    DisjointSets                       sets;     ///< of particles that pairs of this rank connect
    std::vector<std::uint64_t>         label;    ///< lowest id of each particle's island
    std::vector<dealii::Point<dim>>    place;    ///< of particles, by the images of that one's neighbours [m]
    std::vector<std::array<bool, dim>> repeats;  ///< of particles
  };

  template <int dim>
  void
  Islands<dim>::find()
  {
    const auto &particles = system.particles;
    const auto &pairs     = system.pairs;
    Search      search{
      anchors(system), std::vector<std::uint8_t>(system.movers.size()), DisjointSets(particles.size()), {}, {}, {}};
    for (unsigned int i = 0; i < particles.n_free; ++i)
      for (unsigned int p = pairs.row_start[i]; p < pairs.row_fixed[i]; ++p)
        if (pairs.j[p] > i)                 // else united before
          search.sets.unite(pairs.j[p], i); // so that roots stay roots
    find_unheld(search);
    body.clear();
    for (unsigned int m = 0; m < system.movers.size() && body.empty(); ++m)
      if (is_free(system, m) && !search.bodies[m])
        body = system.movers[m].name;

    islands.clear();
    members.clear();
    in_island.clear();
    unsigned int n = 0;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      n += !search.anchored[i];
    if (dealii::Utilities::MPI::max(n, system.scene.comm) == 0)
      return;
    label(search);
    number(search);
    measure();
  }

  /// What is anchored on one rank anchors the set on all: told until nothing is news.
  template <int dim>
  void
  Islands<dim>::find_unheld(Search &search) const
  {
    const auto &particles = system.particles;
    auto       &anchored  = search.anchored;
    for (unsigned int m = 0; m < search.bodies.size(); ++m)
      search.bodies[m] = is_free(system, m) && system.bodies->resists(m);
    for (bool news = true; news;)
      {
        const auto before = anchored;
        if (system.bodies)
          share_with_bodies(search);
        news = anchored != before;
        system.neighbours->update_ghosts(anchored);
        std::vector<std::uint8_t> of_root(particles.size());
        for (unsigned int i = 0; i < particles.size(); ++i)
          of_root[search.sets.root(i)] |= anchored[i];
        for (unsigned int i = 0; i < particles.n_free; ++i)
          if (!anchored[i] && of_root[search.sets.root(i)])
            anchored[i] = news = true;
        news = dealii::Utilities::MPI::max(news ? 1 : 0, system.scene.comm) == 1;
      }
  }

  /// Takes anchors over from particles to the free bodies that they touch, and back. Collective.
  template <int dim>
  void
  Islands<dim>::share_with_bodies(Search &search) const
  {
    const auto &pairs          = system.pairs;
    auto       &anchored       = search.anchored;
    auto       &bodies         = search.bodies;
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

  /// Each island by its lowest id, told until nothing is news; places so that neighbours stay neighbours across periods.
  template <int dim>
  void
  Islands<dim>::label(Search &search) const
  {
    const auto &particles = system.particles;
    const auto  counts    = [&](const unsigned int k) { return !search.anchored[k] && !particles.is_fixed(k); };
    search.label          = particles.id;
    search.place          = particles.x;
    using Origin          = std::pair<std::uint64_t, Tensor<1, dim>>; // lowest id, and by what places are shifted
    std::vector<Origin> of_root;
    for (bool news = true; news;)
      {
        news = false;
        system.neighbours->update_ghosts(search.label);
        system.neighbours->update_ghosts(search.place);
        of_root.assign(particles.size(), {no_label, {}});
        for (unsigned int k = 0; k < particles.size(); ++k)
          if (counts(k))
            if (auto &origin = of_root[search.sets.root(k)]; search.label[k] < origin.first)
              origin = {search.label[k], search.place[k] - particles.x[k]};
        for (unsigned int i = 0; i < particles.n_free; ++i)
          if (const auto &origin = of_root[search.sets.root(i)]; counts(i) && origin.first < search.label[i])
            {
              search.label[i] = origin.first;
              search.place[i] = particles.x[i] + origin.second;
              news            = true;
            }
        news = dealii::Utilities::MPI::max(news ? 1 : 0, system.scene.comm) == 1;
      }

    // An image of a particle whose place does not fit its neighbours' has gone around the period.
    std::vector<std::array<bool, dim>> of_set(particles.size());
    for (unsigned int k = particles.n_owned; k < particles.size(); ++k)
      if (counts(k))
        for (unsigned int d = 0; d < dim; ++d)
          of_set[search.sets.root(k)][d] |= std::abs((search.place[k] - particles.x[k] -
                                                      of_root[search.sets.root(k)].second)[d]) >
                                            .5 * system.settings.arrangement.spacing;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      search.repeats.push_back(of_set[search.sets.root(i)]);
  }

  /// Makes islands of labels, in the order of these.
  template <int dim>
  void
  Islands<dim>::number(const Search &search)
  {
    const auto &particles = system.particles;
    const auto  comm      = system.scene.comm;
    in_island.assign(particles.n_free, 0);
    std::vector<std::uint64_t> labels;
    for (unsigned int i = 0; i < particles.n_free; ++i)
      if (!search.anchored[i])
        labels.push_back(search.label[i]);
    const auto sort = [&] {
      std::sort(labels.begin(), labels.end());
      labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    };
    sort();
    const auto of_ranks = dealii::Utilities::MPI::all_gather(comm, labels);
    for (const auto &others : of_ranks)
      labels.insert(labels.end(), others.begin(), others.end());
    sort();

    islands.resize(labels.size());
    std::vector<double>       X(dim * labels.size(), 0.);
    std::vector<unsigned int> around(dim * labels.size(), 0);
    for (unsigned int i = 0; i < particles.n_free; ++i)
      if (!search.anchored[i])
        {
          in_island[i]   = 1;
          const auto own = static_cast<unsigned int>(std::lower_bound(labels.begin(), labels.end(), search.label[i]) -
                                                     labels.begin());
          members.push_back({i, own, search.place[i]});
          for (unsigned int d = 0; d < dim; ++d)
            {
              if (particles.id[i] == labels[own])
                X[dim * own + d] = particles.X[i][d];
              around[dim * own + d] |= search.repeats[i][d];
            }
        }
    dealii::Utilities::MPI::sum(X, comm, X);
    dealii::Utilities::MPI::max(around, comm, around);
    repeats.resize(labels.size());
    for (unsigned int k = 0; k < labels.size(); ++k)
      for (unsigned int d = 0; d < dim; ++d)
        {
          islands[k].X[d] = X[dim * k + d];
          repeats[k][d]   = around[dim * k + d] != 0;
        }
  }

  template class Islands<2>;
  template class Islands<3>;
} // namespace Stroma::Sph
