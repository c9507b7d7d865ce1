#pragma once

#include <stroma/grid/node_lattice.h>

#include <deal.II/distributed/tria.h>

namespace Stroma
{
  /// An owned cell that carries unknowns.
  template <int dim>
  struct ActiveCell
  {
    typename dealii::Triangulation<dim>::active_cell_iterator cell;
    typename ShapeFunctions<dim>::Index                       index;  ///< in the grid's box
    unsigned int                                              number; ///< among those of this rank
    const int *node; ///< for each of its nodes, where its first unknown stands in the relevant set
  };

  /**
   * The background grid: a box of cells shared out over the ranks by p4est, with displacement unknowns on the nodes of the
   * cells that hold material and none elsewhere.
   *
   * The mesh may have more cells than the box, beyond its upper ends and always empty: their numbers can be halved more
   * often, which makes the coarse mesh small that every rank holds.
   */
  template <int dim>
  class BackgroundGrid
  {
  public:
    using CellIterator = typename dealii::Triangulation<dim>::active_cell_iterator;
    using Index        = typename ShapeFunctions<dim>::Index;

    BackgroundGrid(const GridBox<dim> &box, const ShapeFunctionsEntry<dim> &shape, MPI_Comm comm);

    /// Gives unknowns to the cells marked in @p holds_material (by active_cell_index; owned cells count). Collective.
    void distribute_unknowns(const std::vector<bool> &holds_material);

    /// Whether a cell (owned or ghost) carries unknowns.
    bool
    is_active(const CellIterator &cell) const
    {
      return active[cell->active_cell_index()];
    }

    /// Calls visit(cell, its index in the box) for the cells of the box that this rank owns.
    template <typename Visit>
    void for_owned_cells(const Visit &visit) const;

    /// The owned cells that carry unknowns.
    const std::vector<ActiveCell<dim>> &
    active_cells() const
    {
      return cells;
    }

    const GridBox<dim> &
    box() const
    {
      return grid_box;
    }
    /// On all ranks.
    unsigned long long
    n_active_cells() const
    {
      return n_active;
    }

  private:
    const GridBox<dim> grid_box;

  public:
    dealii::parallel::distributed::Triangulation<dim> triangulation;
    const std::unique_ptr<ShapeFunctions<dim>>        shape;
    NodeLattice<dim>                                  nodes;

  private:
    std::vector<ActiveCell<dim>> cells;
    std::vector<bool>            active; ///< by active_cell_index, of owned and ghost cells
    unsigned long long           n_active = 0;
  };

  template <int dim>
  template <typename Visit>
  void
  BackgroundGrid<dim>::for_owned_cells(const Visit &visit) const
  {
    for (const auto &cell : triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const auto centre = cell->center();
          Index      index;
          bool       is_inside = true;
          for (unsigned int d = 0; d < dim; ++d)
            {
              index[d] = grid_box.cell_index(centre[d], d);
              is_inside &= index[d] < grid_box.n_cells[d];
            }
          if (is_inside)
            visit(cell, index);
        }
  }

  /// Cells of the coarse mesh along each axis, and how often it is refined.
  template <int dim>
  struct CoarseMesh
  {
    std::array<unsigned int, dim> n_cells;
    unsigned int                  refinements;
  };

  /// The coarse mesh for a box with @p n_cells cells: small, and refined with about as many cells as asked for, or more.
  template <int dim>
  CoarseMesh<dim> coarse_mesh(const std::array<unsigned int, dim> &n_cells);
} // namespace Stroma
