#include <stroma/particles/neighbours_cells.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Particles
{
  namespace
  {
    /// Room around the places, over the smallest size, where nothing is periodic: without it the cells' faces would often go
    /// through rows of a lattice, and rounding would tell on which side each particle, and so in what order the equations, are.
    constexpr double room_around = .0137;

    /// Digits of the coordinates in turn, so that cells of near numbers are near.
    template <int dim>
    std::uint64_t
    morton_code(const std::array<int, dim> &c)
    {
      std::uint64_t code = 0;
      for (unsigned int bit = 0; bit < 21; ++bit)
        for (unsigned int d = 0; d < dim; ++d)
          code |= static_cast<std::uint64_t>(c[d] >> bit & 1) << (bit * dim + d);
      return code;
    }
  } // namespace

  template <int dim>
  void
  Cells<dim>::lay(const std::vector<dealii::Point<dim>> &places, const double smallest,
                  const dealii::BoundingBox<dim> &domain, const std::array<bool, dim> &periodic, MPI_Comm comm)
  {
    std::vector<double> largest(2 * dim, -1e300); // of minus coordinates, then of coordinates
    for (const auto &x : places)
      for (unsigned int d = 0; d < dim; ++d)
        {
          largest[d]       = std::max(largest[d], -x[d]);
          largest[dim + d] = std::max(largest[dim + d], x[d]);
        }
    dealii::Utilities::MPI::max(largest, comm, largest);
    const std::uint64_t n_places = dealii::Utilities::MPI::sum(std::uint64_t{places.size()}, comm);
    dealii::Point<dim>  lower, upper;
    for (unsigned int d = 0; d < dim; ++d)
      if (periodic[d])
        {
          lower[d] = domain.lower_bound(d);
          upper[d] = domain.upper_bound(d);
        }
      else if (n_places > 0)
        {
          lower[d] = -largest[d] - room_around * smallest;
          upper[d] = largest[dim + d] + room_around * smallest;
        }
    set_sizes({{lower, upper}}, smallest, periodic, n_places);
  }

  template <int dim>
  void
  Cells<dim>::set_sizes(const dealii::BoundingBox<dim> &box, const double smallest,
                        const std::array<bool, dim> &periodic, const std::uint64_t n_places)
  {
    constexpr double largest_n = 1 << 20;
    Coordinates      wanted;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double fitting = box.side_length(d) / (smallest * (1. + 1e-9)); // rounding must not hide a neighbour
        wanted[d]            = std::max(static_cast<int>(std::min(fitting, largest_n)), periodic[d] ? 2 : 1);
      }
    const auto n_cells = [&] {
      double product = 1.;
      for (const int n_d : wanted)
        product *= n_d;
      return product;
    };
    while (n_cells() > 8. * n_places + (1 << 16)) // particles far from each other
      *std::max_element(wanted.begin(), wanted.end()) /= 2;

    lower = box.get_boundary_points().first;
    for (unsigned int d = 0; d < dim; ++d)
      {
        cell_size[d]    = std::max(box.side_length(d), smallest) / wanted[d];
        inverse_size[d] = 1. / cell_size[d];
      }
    if (wanted != n)
      {
        n = wanted;
        order_along_curve();
      }
  }

  template <int dim>
  void
  Cells<dim>::order_along_curve()
  {
    unsigned int n_cells = 1;
    for (const int n_d : n)
      n_cells *= n_d;
    std::vector<std::pair<std::uint64_t, unsigned int>> along(n_cells);
    Coordinates                                         c{};
    for (unsigned int i = 0; i < n_cells; ++i)
      {
        along[i] = {morton_code<dim>(c), i};
        for (unsigned int d = 0; d < dim && ++c[d] == n[d]; ++d)
          c[d] = 0;
      }
    std::sort(along.begin(), along.end());
    position.resize(n_cells);
    cell_at.resize(n_cells);
    for (unsigned int p = 0; p < n_cells; ++p)
      {
        cell_at[p]                = along[p].second;
        position[along[p].second] = p;
      }
  }

  template <int dim>
  void
  Cells<dim>::divide(const std::vector<dealii::Point<dim>> &places, MPI_Comm comm)
  {
    const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(comm);
    owner.assign(size(), 0);
    first_position.assign(n_ranks + 1, size());
    first_position[0] = 0;
    if (n_ranks == 1)
      return;

    std::vector<std::uint64_t> count(size(), 0);
    for (const auto &x : places)
      ++count[position_of(x)];
    MPI_Allreduce(MPI_IN_PLACE, count.data(), static_cast<int>(count.size()), MPI_UINT64_T, MPI_SUM, comm);
    std::uint64_t total = 0;
    for (const std::uint64_t c : count)
      total += c;
    std::uint64_t before = 0; // a cell belongs to the rank in whose share its middle particle lies
    unsigned int  rank   = 0;
    for (unsigned int p = 0; p < size(); ++p)
      {
        while (rank + 1 < n_ranks && (2 * before + count[p]) * n_ranks > 2 * total * (rank + 1))
          first_position[++rank] = p;
        owner[cell_at[p]] = static_cast<int>(rank);
        before += count[p];
      }
  }

  template <int dim>
  std::array<typename Cells<dim>::Coordinates, 2>
  Cells<dim>::range_of(const int rank) const
  {
    std::array<Coordinates, 2> range;
    range[0] = n;
    range[1].fill(-1);
    for (unsigned int p = first_position[rank]; p < first_position[rank + 1]; ++p)
      for (unsigned int d = 0, rest = cell_at[p]; d < dim; ++d)
        {
          const int c = static_cast<int>(rest % n[d]);
          rest /= n[d];
          range[0][d] = std::min(range[0][d], c);
          range[1][d] = std::max(range[1][d], c);
        }
    return range;
  }

  template class Cells<2>;
  template class Cells<3>;
} // namespace Stroma::Particles
