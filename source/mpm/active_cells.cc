#include <stroma/mpm/active_cells.h>

namespace Stroma::Mpm
{
  template <int dim>
  ActiveCells<dim>::ActiveCells(const BackgroundGrid<dim> &grid)
    : n_nodes(grid.shape->n_nodes())
    , grid(grid)
  {}

  template <int dim>
  void
  ActiveCells<dim>::rebuild(const Solvers::Constraints &constraints)
  {
    const auto &relevant = grid.nodes.relevant;
    relevant.fill_index_vector(index);
    is_held.clear();
    for (const auto &active : *this)
      {
        bool held = false;
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int c = 0; c < dim; ++c)
            held |= constraints.is_constrained(index[active.node[a] + c]);
        is_held.push_back(held);
      }
  }

  template <int dim>
  dealii::Tensor<1, dim>
  ActiveCells<dim>::value(const ActiveCell<dim> &active, const Shapes &shapes, const Vector &relevant) const
  {
    dealii::Tensor<1, dim> result;
    const double          *all = relevant.begin();
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int c = 0; c < dim; ++c)
        result[c] += all[active.node[a] + c] * shapes.value[a];
    return result;
  }

  template <int dim>
  Rigid::CarriedPoint<dim>
  ActiveCells<dim>::carried(const ActiveCell<dim> &active, const dealii::Point<dim> &X) const
  {
    constexpr double   nothing = 1e-9; // of a weight
    dealii::Point<dim> xi;
    for (unsigned int d = 0; d < dim; ++d)
      xi[d] = (X[d] - active.cell->vertex(0)[d]) / grid.box().cell_size[d];
    const auto               at = shapes(active, xi);
    Rigid::CarriedPoint<dim> point;
    point.X = X;
    for (unsigned int a = 0; a < n_nodes; ++a)
      if (std::abs(at.value[a]) > nothing)
        {
          point.nodes.emplace_back();
          point.nodes.back().weight = at.value[a];
          for (unsigned int c = 0; c < dim; ++c)
            point.nodes.back().dofs[c] = index[active.node[a] + c];
        }
    return point;
  }

  template <int dim>
  double
  ActiveCells<dim>::largest(const ActiveCell<dim> &active, const Vector &relevant) const
  {
    double        result = 0;
    const double *all    = relevant.begin();
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int c = 0; c < dim; ++c)
        result = std::max(result, std::abs(all[active.node[a] + c]));
    return result;
  }

  template <int dim>
  void
  ActiveCells<dim>::find_unknowns(const ActiveCell<dim>                        &active,
                                  std::vector<dealii::types::global_dof_index> &unknowns) const
  {
    unknowns.resize(dim * n_nodes);
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int c = 0; c < dim; ++c)
        unknowns[a * dim + c] = index[active.node[a] + c];
  }

  template <int dim>
  void
  ActiveCells<dim>::add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const
  {
    std::vector<dealii::types::global_dof_index> unknowns;
    for (const auto &active : *this)
      {
        find_unknowns(active, unknowns);
        constraints.add_entries_local_to_global(unknowns, pattern, false);
      }
  }

  template <int dim>
  ActiveCells<dim>::Assembly::Assembly(const ActiveCells &cells, Matrix &K, Vector &r,
                                       const Solvers::Constraints &constraints)
    : cells(cells)
    , K(K)
    , r(r)
    , constraints(constraints)
    , scatter(K, cells.grid.nodes.relevant, cells.n_nodes)
    , zero(dim * cells.n_nodes)
  {}

  template <int dim>
  void
  ActiveCells<dim>::Assembly::add(const ActiveCell<dim> &active, const dealii::FullMatrix<double> &K_cell)
  {
    if (!cells.is_held[active.number] && scatter.add(active.node, K_cell))
      return;
    cells.find_unknowns(active, unknowns);
    constraints.distribute_local_to_global(K_cell, zero, unknowns, K, r, true);
  }

  template class ActiveCells<2>;
  template class ActiveCells<3>;
} // namespace Stroma::Mpm
