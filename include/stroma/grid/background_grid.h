#pragma once

#include <stroma/base/types.h>

#include <deal.II/base/index_set.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/hp/fe_collection.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

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

  /**
   * The background grid: a box of cells shared out over the ranks by p4est, with trilinear (bilinear) displacement
   * unknowns on the cells that hold material and none elsewhere.
   */
  template <int dim>
  class BackgroundGrid
  {
  public:
    using CellIterator = typename dealii::DoFHandler<dim>::active_cell_iterator;

    BackgroundGrid(const GridBox<dim> &box, MPI_Comm comm);

    /// Gives unknowns to the cells marked in @p holds_material (by active_cell_index; owned cells count). Collective.
    void distribute_unknowns(const std::vector<bool> &holds_material);

    /// Whether a cell (owned or ghost) carries unknowns.
    bool
    is_active(const CellIterator &cell) const
    {
      return !has_empty_cells || cell->active_fe_index() == 0;
    }

    const GridBox<dim> &
    box() const
    {
      return grid_box;
    }
    unsigned long long
    n_active_cells() const
    {
      return active_cells;
    }

    dealii::parallel::distributed::Triangulation<dim> triangulation;
    dealii::DoFHandler<dim>                           dofs;
    dealii::IndexSet                                  owned, relevant;

  private:
    GridBox<dim>                  grid_box;
    dealii::hp::FECollection<dim> elements; // active, empty
    bool                          has_empty_cells = false;
    unsigned long long            active_cells    = 0;
  };
} // namespace Stroma
