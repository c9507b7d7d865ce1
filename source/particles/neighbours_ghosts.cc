#include <stroma/particles/neighbours.h>
#include <stroma/particles/neighbours_ghosts.h>

namespace Stroma::Particles
{
  template <int dim>
  void
  Neighbours<dim>::make_ghosts(ParticleSet<dim> &particles)
  {
    ghosts.clear();
    image.clear();
    if (n_ranks == 1 && !any_periodic())
      return;

    std::vector<std::vector<unsigned int>> send(n_ranks);
    std::vector<std::vector<std::uint8_t>> codes(n_ranks);
    GhostFinder<dim>                       finder(cells, settings.periodic, rank, reach());
    for (unsigned int i = 0; i < particles.n_owned; ++i)
      finder.for_each_ghost(particles.x_search[i], [&](const unsigned int to, const std::uint8_t code) {
        send[to].push_back(i);
        codes[to].push_back(code);
      });
    ghosts.reinit(send, particles.n_owned);
    if (any_periodic())
      {
        std::vector<std::uint8_t> packed;
        for (const auto &of_rank : codes)
          packed.insert(packed.end(), of_rank.begin(), of_rank.end());
        image = ghosts.copy_packed(packed);
      }
    visit_used(particles, [&](auto &field) {
      field.resize(particles.n_owned + ghosts.n_received());
      update_ghosts(field);
    });
    update_ghost_places(particles.x);
    update_ghost_places(particles.x_search);
  }

  template <int dim>
  void
  Neighbours<dim>::update_ghost_places(std::vector<dealii::Point<dim>> &x) const
  {
    ghosts.copy(x);
    const std::size_t first = x.size() - image.size();
    for (unsigned int g = 0; g < image.size(); ++g)
      if (image[g] != no_shift<dim>)
        x[first + g] += shifts[image[g]];
  }

  template void Neighbours<2>::make_ghosts(ParticleSet<2> &);
  template void Neighbours<3>::make_ghosts(ParticleSet<3> &);
  template void Neighbours<2>::update_ghost_places(std::vector<dealii::Point<2>> &) const;
  template void Neighbours<3>::update_ghost_places(std::vector<dealii::Point<3>> &) const;
} // namespace Stroma::Particles
