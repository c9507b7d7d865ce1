#pragma once

#include <stroma/particles/neighbours_cells.h>

#include <algorithm>
#include <tuple>

namespace Stroma::Particles
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

  /// Finds the ranks that own places within a reach, which is no longer than a cell, of particles: of one cell's after the other.
  template <int dim>
  class GhostFinder
  {
  public:
    /// @param rank which needs no ghosts of what stands in its own cells; invalid_unsigned_int: each needs all
    GhostFinder(const Cells<dim> &cells, const std::array<bool, dim> &periodic, const unsigned int rank,
                const double reach)
      : cells(cells)
      , periodic(periodic)
      , rank(rank)
      , largest_square(reach * reach * (1. + 1e-6)) // rounding must not hide a neighbour
    {
      cell.fill(-1);
    }

    /// Calls f(rank, code) for each ghost of the particle at @p x, by rank.
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
} // namespace Stroma::Particles
