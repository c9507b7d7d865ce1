#include <stroma/mpm/active_cells.h>

namespace Stroma::Mpm
{
  template <int dim>
  void
  ActiveCells<dim>::rebuild(const BackgroundGrid<dim> &grid, const Solvers::Constraints &constraints)
  {
    relevant = grid.relevant;
    nodal.resize(relevant.n_elements());
    relevant.fill_index_vector(index);
    cells.clear();
    std::vector<dealii::types::global_dof_index> dofs(dim * n_nodes);
    for (const auto &cell : grid.dofs.active_cell_iterators())
      if (cell->is_locally_owned() && grid.is_active(cell))
        {
          cell->get_dof_indices(dofs);
          ActiveCell<dim> active;
          active.cell    = cell;
          active.is_held = false;
          for (const auto dof : dofs)
            active.is_held |= constraints.is_constrained(dof);
          for (unsigned int a = 0; a < n_nodes; ++a)
            active.node[a] = relevant.index_within_set(dofs[a * dim]);
          cells.push_back(active);
        }
  }

  template <int dim>
  ActiveCells<dim>::Assembly::Assembly(const ActiveCells &cells, Matrix &K, Vector &r,
                                       const Solvers::Constraints &constraints)
    : cells(cells)
    , K(K)
    , r(r)
    , constraints(constraints)
    , scatter(K, cells.relevant)
    , zero(dim * n_nodes)
    , dofs(dim * n_nodes)
  {}

  template <int dim>
  void
  ActiveCells<dim>::Assembly::add(const ActiveCell<dim> &active, const dealii::FullMatrix<double> &K_cell)
  {
    if (!active.is_held && scatter.add(active.node, K_cell))
      return;
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int c = 0; c < dim; ++c)
        dofs[a * dim + c] = cells.index[active.node[a] + c];
    constraints.distribute_local_to_global(K_cell, zero, dofs, K, r, true);
  }

  template class ActiveCells<2>;
  template class ActiveCells<3>;
} // namespace Stroma::Mpm
