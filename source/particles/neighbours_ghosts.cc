#include <stroma/particles/neighbours.h>

#include <algorithm>
#include <tuple>

namespace Stroma::Particles
{
  namespace
  {
    /// Who must know the particles of a cell that are near the cell at some offset, and as which image.
    template <int dim>
    struct Receiver
    {
      unsigned int         rank;
      std::uint8_t         code;
      std::array<int, dim> offset;

      bool
      same_ghost(const Receiver &other) const
      {
        return rank == other.rank && code == other.code;
      }
    };

    template <int dim>
    constexpr std::uint8_t no_shift = dim == 2 ? 4 : 13; ///< code of a ghost that is no image

    /// Finds the ghosts of the particles of one cell after the other.
    template <int dim>
    class GhostFinder
    {
    public:
      GhostFinder(const Cells<dim> &cells, const std::array<bool, dim> &periodic, const unsigned int rank,
                  const double reach)
        : cells(cells)
        , periodic(periodic)
        , rank(rank)
        , largest_square(reach * reach * (1. + 1e-6)) // rounding must not hide a neighbour
      {
        cell.fill(-1);
      }

      /// Calls f(rank, code) for each ghost of the particle at @p x.
      template <typename Function>
      void
      for_each_ghost(const dealii::Point<dim> &x, const Function &f)
      {
        const auto c = cells.coordinates(x);
        if (c != cell)
          find_receivers(c);
        for (unsigned int r = 0; r < receivers.size();)
          {
            const auto &ghost = receivers[r];
            bool        near  = false;
            for (; r < receivers.size() && receivers[r].same_ghost(ghost); ++r)
              near = near || is_near(x, receivers[r].offset);
            if (near)
              f(ghost.rank, ghost.code);
          }
      }

    private:
      void
      find_receivers(const typename Cells<dim>::Coordinates &c)
      {
        cell = c;
        receivers.clear();
        std::array<int, dim> offset;
        offset.fill(-1);
        for (unsigned int k = 0; k < (dim == 2 ? 9 : 27); ++k)
          {
            add_receiver(offset);
            for (unsigned int d = 0; d < dim && ++offset[d] == 2; ++d)
              offset[d] = -1;
          }
        std::sort(receivers.begin(), receivers.end(), [](const auto &a, const auto &b) {
          return std::tie(a.rank, a.code, a.offset) < std::tie(b.rank, b.code, b.offset);
        });
      }

      void
      add_receiver(const std::array<int, dim> &offset)
      {
        auto         c    = cell;
        unsigned int code = 0;
        for (unsigned int d = 0; d < dim; ++d)
          {
            c[d] += offset[d];
            const int wraps = c[d] < 0 ? 1 : (c[d] >= cells.n[d] ? -1 : 0);
            if (wraps != 0 && !periodic[d])
              return;
            c[d] += wraps * cells.n[d];
            code = 3 * code + static_cast<unsigned int>(wraps + 1);
          }
        const unsigned int owner = cells.owner[cells.index(c)];
        if (owner != rank || code != no_shift<dim>)
          receivers.push_back({owner, static_cast<std::uint8_t>(code), offset});
      }

      /// Whether the cell at this offset has places within the reach of @p x.
      bool
      is_near(const dealii::Point<dim> &x, const std::array<int, dim> &offset) const
      {
        double square = 0.;
        for (unsigned int d = 0; d < dim; ++d)
          if (offset[d] != 0)
            {
              const double below = x[d] - cells.lower[d] - cell[d] * cells.cell_size[d];
              const double gap   = std::max(0., offset[d] < 0 ? below : cells.cell_size[d] - below);
              square += gap * gap;
            }
        return square <= largest_square;
      }

      const Cells<dim>                &cells;
      const std::array<bool, dim>      periodic;
      const unsigned int               rank;
      const double                     largest_square;
      typename Cells<dim>::Coordinates cell;
      std::vector<Receiver<dim>>       receivers;
    };
  } // namespace

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
      finder.for_each_ghost(particles.x[i], [&](const unsigned int to, const std::uint8_t code) {
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
