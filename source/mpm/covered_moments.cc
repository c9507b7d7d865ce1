#include <stroma/mpm/covered_moments.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Mpm
{
  template <int dim>
  CellMoments<dim>
  mean_products(const dealii::Point<dim> &middle, const dealii::Tensor<1, dim> &size)
  {
    CellMoments<dim> mean;
    mean[0] = 1.;
    for (unsigned int d = 0, n = 1; d < dim; ++d, n *= 3)
      for (unsigned int k = 0; k < n; ++k)
        {
          mean[k + n]     = mean[k] * middle[d];
          mean[k + 2 * n] = mean[k] * (middle[d] * middle[d] + size[d] * size[d] / 12.);
        }
    return mean;
  }

  /// What a point stands for now, in the plane or in space.
  template <int dim>
  struct CoveredMoments<dim>::PointBox
  {
    double                                         volume; ///< [m^dim]
    dealii::Tensor<1, dim>                         size;   ///< of the upright box of a part [m]
    std::array<dealii::Tensor<1, dim>, (1 << dim)> part;   ///< their centres, from the point [m]

    PointBox(const Points<dim> &points, const double *numbers, const dealii::Tensor<1, dim> &cell_size)
    {
      const auto             F      = points.deformation_of(numbers);
      const double          *sides  = numbers + points.sides.first;
      double                 filled = 1.;
      dealii::Tensor<2, dim> edge; // by columns, of a part
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int i = 0; i < dim; ++i)
          edge[i][k] = .5 * F[i][k] * sides[k];
      volume = points.undeformed_size(numbers) * determinant(F);
      for (unsigned int i = 0; i < dim; ++i)
        {
          for (unsigned int k = 0; k < dim; ++k)
            size[i] = std::max(size[i], std::abs(edge[i][k]));
          filled *= size[i];
        }
      const double scale = std::pow(volume / part.size() / filled, 1. / dim);
      for (unsigned int i = 0; i < dim; ++i)
        size[i] = std::min(scale * size[i], cell_size[i]); // within the ghost cells
      for (unsigned int s = 0; s < part.size(); ++s)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            part[s][i] += (s >> k & 1 ? .5 : -.5) * edge[i][k];
    }
  };

  template <int dim>
  CoveredMoments<dim>::CoveredMoments(const Points<dim> &points, const BackgroundGrid<dim> &grid)
    : grid(grid)
  {
    const auto &box = grid.box();
    for (const auto &cell : grid.triangulation.active_cell_iterators())
      if (!cell->is_artificial() && box.contains(cell->center()) && grid.is_active(cell))
        known.emplace(box.cell_number(cell->center()), cell->subdomain_id());
    for (const auto &active : grid.active_cells())
      for (const auto &point : points.handler.particles_in_cell(active.cell))
        add(PointBox(points, point.get_properties().data(), box.cell_size), point.get_location(),
            box.cell_number(active.cell->center()));
    exchange();
  }

  template <int dim>
  CellMoments<dim>
  CoveredMoments<dim>::of(const ActiveCell<dim> &active)
  {
    constexpr double       taken_for_full = .02, taken_as_it_is = .06;
    const std::uint64_t    number = grid.box().cell_number(active.cell->center());
    double                 volume = 1.;
    dealii::Tensor<1, dim> whole;
    for (unsigned int d = 0; d < dim; ++d)
      {
        volume *= grid.box().cell_size[d];
        whole[d] = 1.;
      }
    const CellMoments<dim> covered = sum_of(number);
    const double           apart   = std::abs(covered[0] / volume - 1.);
    const double           share   = (taken_as_it_is - apart) / (taken_as_it_is - taken_for_full);
    if (share <= 0. || !is_inner(number))
      return covered;
    const double full = std::min(share, 1.);
    return full * volume * mean_products<dim>({}, whole) + (1. - full) * covered;
  }

  /// Adds the parts of the box of a point in the cell @p own.
  template <int dim>
  void
  CoveredMoments<dim>::add(const PointBox &box, const dealii::Point<dim> &x, const std::uint64_t own)
  {
    for (const auto &from_point : box.part)
      add_upright(x + from_point, box.size, box.volume / box.part.size(), own);
  }

  /// Brings what other ranks know of this rank's cells. Collective.
  template <int dim>
  void
  CoveredMoments<dim>::exchange()
  {
    const MPI_Comm                              comm = grid.triangulation.get_communicator();
    const unsigned int                          self = dealii::Utilities::MPI::this_mpi_process(comm);
    std::map<unsigned int, std::vector<double>> parcels;
    for (const auto &[number, sum] : sums)
      if (const unsigned int owner = known.at(number); owner != self)
        {
          parcels[owner].push_back(static_cast<double>(number));
          parcels[owner].insert(parcels[owner].end(), sum.begin(), sum.end());
        }
    for (const auto &[from, arrived] : dealii::Utilities::MPI::some_to_some(comm, parcels))
      for (auto next = arrived.begin(); next != arrived.end(); next += 1 + power(3, dim))
        sum_of(static_cast<std::uint64_t>(*next)) += Eigen::Map<const CellMoments<dim>>(&*next + 1);
  }

  template <int dim>
  CellMoments<dim> &
  CoveredMoments<dim>::sum_of(const std::uint64_t number)
  {
    return sums.emplace(number, CellMoments<dim>::Zero()).first->second;
  }

  /// Number of a cell with points; none for others.
  template <int dim>
  std::optional<std::uint64_t>
  CoveredMoments<dim>::number_of(const Index &index) const
  {
    std::uint64_t number = 0;
    for (int d = dim - 1; d >= 0; --d)
      {
        if (index[d] < 0 || index[d] >= static_cast<int>(grid.box().n_cells[d]))
          return std::nullopt;
        number = number * grid.box().n_cells[d] + index[d];
      }
    return known.count(number) ? std::optional(number) : std::nullopt;
  }

  template <int dim>
  typename CoveredMoments<dim>::Index
  CoveredMoments<dim>::index_of(std::uint64_t number) const
  {
    Index index;
    for (unsigned int d = 0; d < dim; ++d)
      {
        index[d] = static_cast<int>(number % grid.box().n_cells[d]);
        number /= grid.box().n_cells[d];
      }
    return index;
  }

  /// Whether all neighbours of a cell on the grid hold points.
  template <int dim>
  bool
  CoveredMoments<dim>::is_inner(const std::uint64_t number) const
  {
    for (unsigned int k = 0; k < power(3, dim); ++k)
      {
        auto other   = index_of(number);
        bool on_grid = true;
        for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
          {
            other[d] += static_cast<int>(rest % 3) - 1;
            on_grid &= other[d] >= 0 && other[d] < static_cast<int>(grid.box().n_cells[d]);
          }
        if (on_grid && !number_of(other))
          return false;
      }
    return true;
  }

  /// An upright box, cut by the cells' faces.
  template <int dim>
  void
  CoveredMoments<dim>::add_upright(const dealii::Point<dim> &centre, const dealii::Tensor<1, dim> &size,
                                   const double volume, const std::uint64_t own)
  {
    struct Piece
    {
      int    cell;
      double middle, share; // in cells from the grid's lower end; of the box
    };
    std::array<std::array<Piece, 3>, dim> pieces;
    std::array<unsigned int, dim>         n{};
    unsigned int                          n_all = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double h      = grid.box().cell_size[d];
        const double length = size[d] / h;
        double       begin  = (centre[d] - grid.box().lower[d]) / h - .5 * length;
        const double upper  = begin + length;
        while (n[d] < 3 && begin < upper - 1e-9)
          {
            const double face = std::min(std::floor(begin + 1e-9) + 1., upper);
            pieces[d][n[d]++] = {static_cast<int>(std::floor(begin + 1e-9)), .5 * (begin + face),
                                 (face - begin) / length};
            begin             = face;
          }
        n_all *= n[d];
      }
    for (unsigned int i = 0; i < n_all; ++i)
      {
        Index                  index;
        dealii::Point<dim>     middle;
        dealii::Tensor<1, dim> side;
        double                 part = volume;
        for (unsigned int d = 0, rest = i; d < dim; rest /= n[d++])
          {
            const Piece &piece = pieces[d][rest % n[d]];
            index[d]           = piece.cell;
            middle[d]          = piece.middle;
            side[d]            = piece.share * size[d] / grid.box().cell_size[d];
            part *= piece.share;
          }
        const auto found  = number_of(index);
        const auto target = found.value_or(own);
        const auto at     = found ? index : index_of(own);
        for (unsigned int d = 0; d < dim; ++d)
          middle[d] -= at[d] + .5;
        sum_of(target) += part * mean_products<dim>(middle, side);
      }
  }

  template CellMoments<2> mean_products<2>(const dealii::Point<2> &, const dealii::Tensor<1, 2> &);
  template CellMoments<3> mean_products<3>(const dealii::Point<3> &, const dealii::Tensor<1, 3> &);
  template class CoveredMoments<2>;
  template class CoveredMoments<3>;
} // namespace Stroma::Mpm
