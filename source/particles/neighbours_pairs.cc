#include <stroma/particles/neighbours.h>

#include "neighbours_sort.h"

#include <algorithm>

namespace Stroma::Particles
{
  namespace
  {
    constexpr unsigned int
    power_of_3(const unsigned int n)
    {
      return n == 0 ? 1 : 3 * power_of_3(n - 1);
    }

    /// All particles in the order of rows: free ones by id, then fixed ones; images by their shift.
    template <int dim>
    std::vector<unsigned int>
    row_order(const ParticleSet<dim> &particles, const std::vector<std::uint8_t> &image)
    {
      std::vector<unsigned int> order(particles.size());
      for (unsigned int i = 0; i < order.size(); ++i)
        order[i] = i;
      PassSort by(order);
      if (!image.empty())
        by.pass(power_of_3(dim), [&](const unsigned int i) -> unsigned int {
          return i < particles.n_owned ? power_of_3(dim) / 2 : image[i - particles.n_owned];
        });
      by.pass_ids(particles.id);
      if (!particles.mover.empty())
        by.pass(2, [&](const unsigned int i) { return particles.is_fixed(i) ? 1u : 0u; });
      return order;
    }

    /// The particles in the cells of one rank and around them, cell by cell. Images have cells of their own beyond the
    /// periodic faces.
    template <int dim>
    class CellLists
    {
    public:
      CellLists(const Cells<dim> &cells, const std::array<typename Cells<dim>::Coordinates, 2> &range,
                const ParticleSet<dim> &particles, const std::vector<std::uint8_t> &image)
        : cells(cells)
        , order(row_order(particles, image))
      {
        unsigned int n_cells = 1;
        for (unsigned int d = 0; d < dim; ++d)
          {
            lower[d]  = range[0][d] - 1;
            stride[d] = n_cells;
            n_cells *= range[1][d] - range[0][d] + 3;
          }
        cell_of.resize(particles.size());
        for (unsigned int i = 0; i < particles.size(); ++i)
          cell_of[i] = index(coordinates(particles, image, i));
        fill(n_cells);
        for (unsigned int k = 0; k < power_of_3(dim); ++k)
          for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
            around[k] += (static_cast<int>(rest % 3) - 1) * static_cast<int>(stride[d]);
      }

      unsigned int
      cell(const unsigned int i) const
      {
        return cell_of[i];
      }

      /// Particles in and around a cell, in the order of rows.
      void
      candidates(const unsigned int cell, std::vector<unsigned int> &result)
      {
        merged.clear();
        ends.assign(1, 0);
        for (const int offset : around)
          {
            merged.insert(merged.end(), place.begin() + start[cell + offset], place.begin() + start[cell + offset + 1]);
            if (merged.size() > ends.back())
              ends.push_back(static_cast<unsigned int>(merged.size()));
          }
        merge();
        result.resize(merged.size());
        for (unsigned int k = 0; k < merged.size(); ++k)
          result[k] = order[merged[k]];
      }

    private:
      typename Cells<dim>::Coordinates
      coordinates(const ParticleSet<dim> &particles, const std::vector<std::uint8_t> &image, const unsigned int i) const
      {
        auto c = cells.coordinates(particles.x_search[i]);
        if (i >= particles.n_owned && !image.empty())
          for (unsigned int d = dim, rest = image[i - particles.n_owned]; d-- > 0; rest /= 3)
            if (rest % 3 != 1)
              c[d] = rest % 3 == 0 ? -1 : cells.n[d];
        return c;
      }

      unsigned int
      index(const typename Cells<dim>::Coordinates &c) const
      {
        unsigned int result = 0;
        for (unsigned int d = 0; d < dim; ++d)
          result += stride[d] * static_cast<unsigned int>(c[d] - lower[d]);
        return result;
      }

      void
      fill(const unsigned int n_cells)
      {
        start.assign(n_cells + 2, 0);
        for (const unsigned int c : cell_of)
          ++start[c + 2];
        for (unsigned int c = 2; c < start.size(); ++c)
          start[c] += start[c - 1];
        place.resize(order.size());
        for (unsigned int k = 0; k < order.size(); ++k)
          place[start[cell_of[order[k]] + 1]++] = k;
      }

      /// Merges neighbouring sorted runs until one is left.
      void
      merge()
      {
        scratch.resize(merged.size());
        while (ends.size() > 2)
          {
            unsigned int n_ends = 1, r = 0;
            for (; r + 2 < ends.size(); r += 2)
              {
                merge_two(merged.data() + ends[r], merged.data() + ends[r + 1], merged.data() + ends[r + 2],
                          scratch.data() + ends[r]);
                ends[n_ends++] = ends[r + 2];
              }
            if (r + 1 < ends.size())
              {
                std::copy(merged.begin() + ends[r], merged.end(), scratch.begin() + ends[r]);
                ends[n_ends++] = ends[r + 1];
              }
            ends.resize(n_ends);
            merged.swap(scratch);
          }
      }

      static void
      merge_two(const unsigned int *a, const unsigned int *const middle, const unsigned int *const end,
                unsigned int *out)
      {
        const unsigned int *b = middle;
        while (a < middle && b < end)
          {
            const unsigned int va = *a, vb = *b;
            const bool         second = vb < va;
            *out++                    = second ? vb : va;
            b += second;
            a += !second;
          }
        out = std::copy(a, middle, out);
        std::copy(b, end, out);
      }

      const Cells<dim>                &cells;
      typename Cells<dim>::Coordinates lower;
      std::array<unsigned int, dim>    stride;

      const std::vector<unsigned int>  order;
      std::vector<unsigned int>        cell_of;  ///< of each particle
      std::vector<unsigned int>        start;    ///< of each cell in place
      std::vector<unsigned int>        place;    ///< in the order of rows, cell by cell, ascending in each
      std::array<int, power_of_3(dim)> around{}; ///< differences of cell indices
      std::vector<unsigned int>        merged, scratch, ends;
    };

    /// Writes to @p row those candidates that are within the reach of particle @p i at @p x; returns how many.
    template <int dim>
    unsigned int
    find_near(const std::vector<unsigned int> &candidates, const std::vector<double> &places, const unsigned int i,
              const dealii::Point<dim> &x, const double reach_square, std::vector<std::uint8_t> &near,
              unsigned int *row)
    {
      const std::size_t   n          = candidates.size();
      const double       *place      = places.data();
      const unsigned int *candidate  = candidates.data();
      std::uint8_t       *is_near    = near.data();
      const auto          coordinate = x; // a copy, so that writing flags cannot change it
      for (std::size_t k = 0; k < n; ++k)
        {
          double square = 0.;
          for (unsigned int d = 0; d < dim; ++d)
            square += (place[d * n + k] - coordinate[d]) * (place[d * n + k] - coordinate[d]);
          is_near[k] = square <= reach_square;
        }
      unsigned int n_near = 0;
      for (std::size_t k = 0; k < n; ++k) // without branches
        {
          row[n_near] = candidate[k];
          n_near += is_near[k];
        }
      return static_cast<unsigned int>(std::remove(row, row + n_near, i) - row);
    }
  } // namespace

  template <int dim>
  void
  Neighbours<dim>::make_pairs(const ParticleSet<dim> &particles)
  {
    const unsigned int n = settings.rows_of_fixed ? particles.n_owned : particles.n_free;
    row_start.assign(n + 1, 0);
    if (n == 0)
      {
        neighbour.clear();
        return;
      }
    CellLists<dim>            lists(cells, cells.range_of(rank), particles, image);
    std::vector<unsigned int> candidates;
    std::vector<double>       places;
    std::vector<std::uint8_t> near;
    unsigned int              cell = dealii::numbers::invalid_unsigned_int;
    for (unsigned int i = 0; i < n; ++i)
      {
        if (lists.cell(i) != cell)
          {
            cell = lists.cell(i);
            lists.candidates(cell, candidates);
            near.resize(candidates.size());
            places.resize(dim * candidates.size());
            for (unsigned int k = 0; k < candidates.size(); ++k)
              for (unsigned int d = 0; d < dim; ++d)
                places[d * candidates.size() + k] = particles.x_search[candidates[k]][d];
          }
        if (neighbour.size() < row_start[i] + candidates.size())
          neighbour.resize(row_start[i] + candidates.size() + neighbour.size() / 2);
        row_start[i + 1] = row_start[i] + find_near(candidates, places, i, particles.x_search[i], reach() * reach(),
                                                    near, neighbour.data() + row_start[i]);
      }
    neighbour.resize(row_start[n]);
  }

  template void Neighbours<2>::make_pairs(const ParticleSet<2> &);
  template void Neighbours<3>::make_pairs(const ParticleSet<3> &);
} // namespace Stroma::Particles
