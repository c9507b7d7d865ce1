#pragma once

#include <stroma/grid/background_grid.h>
#include <stroma/grid/cell_scatter.h>
#include <stroma/rigid/coupling.h>
#include <stroma/solvers/term.h>

namespace Stroma::Mpm
{
  /// The owned cells that hold points, and the way between their nodes and distributed vectors and matrices.
  template <int dim>
  class ActiveCells
  {
  public:
    using Shapes = typename ShapeFunctions<dim>::AtPlace;

    explicit ActiveCells(const BackgroundGrid<dim> &grid);

    /// For the grid's present unknowns.
    void rebuild(const Solvers::Constraints &constraints);

    auto
    begin() const
    {
      return grid.active_cells().begin();
    }
    auto
    end() const
    {
      return grid.active_cells().end();
    }

    /// Nodes of a cell.
    const unsigned int n_nodes;

    /// Values at a cell's nodes of a vector with ghosts, by component.
    template <unsigned int n>
    std::array<Lanes<n>, dim>
    at_nodes(const ActiveCell<dim> &active, const Vector &relevant) const
    {
      std::array<Lanes<n>, dim> values;
      const double             *all = relevant.begin();
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int a = 0; a < n; ++a)
          values[c][a] = all[active.node[a] + c];
      return values;
    }

    /// The shape functions of a cell's nodes at the place @p xi of the unit cell.
    Shapes
    shapes(const ActiveCell<dim> &active, const dealii::Point<dim> &xi) const
    {
      return grid.shape->at(active.index, xi);
    }

    /// Value there of a vector with ghosts.
    dealii::Tensor<1, dim> value(const ActiveCell<dim> &active, const Shapes &shapes, const Vector &relevant) const;

    /// A point of the material at @p X [m], carried by the nodes of a cell, in which it may also lie a little outside.
    Rigid::CarriedPoint<dim> carried(const ActiveCell<dim> &active, const dealii::Point<dim> &X) const;

    /// Largest component at a cell's nodes of a vector with ghosts.
    double largest(const ActiveCell<dim> &active, const Vector &relevant) const;

    /// Sums up @p sum(nodal), where nodal is a number an unknown of the relevant set, and adds it to @p r. Compress afterwards.
    template <typename Sum>
    void
    add_nodal(Vector &r, const Sum &sum)
    {
      std::vector<double> nodal(index.size());
      sum(nodal);
      r.add(index, nodal);
    }

    /// Adds the places of all cells' matrices.
    void add_pattern(Solvers::Pattern &pattern, const Solvers::Constraints &constraints) const;

    /// Adds matrices of cells to one that is distributed.
    class Assembly
    {
    public:
      Assembly(const ActiveCells &cells, Matrix &K, Vector &r, const Solvers::Constraints &constraints);
      /// @p K_cell unknowns node by node. Compress afterwards.
      void add(const ActiveCell<dim> &active, const dealii::FullMatrix<double> &K_cell);

    private:
      const ActiveCells                           &cells;
      Matrix                                      &K;
      Vector                                      &r;
      const Solvers::Constraints                  &constraints;
      CellScatter<dim>                             scatter;
      dealii::Vector<double>                       zero;
      std::vector<dealii::types::global_dof_index> unknowns;
    };

  private:
    void find_unknowns(const ActiveCell<dim> &active, std::vector<dealii::types::global_dof_index> &unknowns) const;

    const BackgroundGrid<dim>                   &grid;
    std::vector<bool>                            is_held; ///< whether the cell has a held unknown, by its number
    std::vector<dealii::types::global_dof_index> index;   ///< of each relevant unknown
  };
} // namespace Stroma::Mpm
