#pragma once

#include <deal.II/base/point.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace Stroma
{
  /// Box of equal rectangular cells.
  template <int dim>
  struct GridBox
  {
    dealii::Point<dim>            lower;     ///< [m]
    dealii::Tensor<1, dim>        cell_size; ///< [m]
    std::array<unsigned int, dim> n_cells;

    dealii::Point<dim>
    upper() const
    {
      dealii::Point<dim> corner = lower;
      for (unsigned int d = 0; d < dim; ++d)
        corner[d] += n_cells[d] * cell_size[d];
      return corner;
    }

    /// Index along axis @p d of the cell that owns coordinate @p x. A point on a face belongs to the cell above it,
    /// with a tolerance against round-off; the last cell owns its upper face. May lie outside [0, n_cells).
    int
    cell_index(const double x, const unsigned int d) const
    {
      const double place = (x - lower[d]) / cell_size[d] + 1e-9;
      const int    index = static_cast<int>(std::floor(place));
      return (index == static_cast<int>(n_cells[d]) && place < n_cells[d] + 2e-9) ? index - 1 : index;
    }

    /// Indices of the cell that owns @p x, as cell_index().
    std::array<int, dim>
    cell_indices(const dealii::Point<dim> &x) const
    {
      std::array<int, dim> index;
      for (unsigned int d = 0; d < dim; ++d)
        index[d] = cell_index(x[d], d);
      return index;
    }

    /// Whether a cell of the box owns @p x.
    bool
    contains(const dealii::Point<dim> &x) const
    {
      const auto index = cell_indices(x);
      for (unsigned int d = 0; d < dim; ++d)
        if (index[d] < 0 || index[d] >= static_cast<int>(n_cells[d]))
          return false;
      return true;
    }

    /// Number of the cell that owns @p x, which must lie on the grid; x fastest.
    std::uint64_t
    cell_number(const dealii::Point<dim> &x) const
    {
      std::uint64_t number = 0;
      for (int d = dim - 1; d >= 0; --d)
        number = number * n_cells[d] + cell_index(x[d], d);
      return number;
    }

    /// Centre of the cell that owns @p x.
    dealii::Point<dim>
    cell_centre(const dealii::Point<dim> &x) const
    {
      dealii::Point<dim> centre;
      for (unsigned int d = 0; d < dim; ++d)
        centre[d] = lower[d] + (cell_index(x[d], d) + .5) * cell_size[d];
      return centre;
    }

    /// Place of @p x in the cell that owns it, as in the unit cell.
    dealii::Point<dim>
    place_in_cell(const dealii::Point<dim> &x) const
    {
      dealii::Point<dim> xi;
      for (unsigned int d = 0; d < dim; ++d)
        xi[d] = (x[d] - lower[d]) / cell_size[d] - cell_index(x[d], d);
      return xi;
    }
  };
} // namespace Stroma
