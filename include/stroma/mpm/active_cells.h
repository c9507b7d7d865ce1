#pragma once

#include <stroma/grid/background_grid.h>
#include <stroma/grid/cell_scatter.h>
#include <stroma/solid/lanes.h>
#include <stroma/solvers/term.h>

namespace Stroma::Mpm
{
  /// An owned cell that holds points.
  template <int dim>
  struct ActiveCell
  {
    typename dealii::DoFHandler<dim>::active_cell_iterator cell;
    bool                                                   is_held; ///< has a held unknown
    std::array<int, 1u << dim> node; ///< position of the node's first unknown in the relevant set
  };

  /// The owned cells that hold points, and the way between their nodes and distributed vectors and matrices.
  template <int dim>
  class ActiveCells
  {
  public:
    using L                               = Solid::Lanes<dim>;
    static constexpr unsigned int n_nodes = 1u << dim;

    /// For the grid's present unknowns.
    void rebuild(const BackgroundGrid<dim> &grid, const Solvers::Constraints &constraints);

    auto
    begin() const
    {
      return cells.begin();
    }
    auto
    end() const
    {
      return cells.end();
    }

    /// Values at a cell's nodes of a vector with ghosts, by component.
    std::array<L, dim>
    at_nodes(const ActiveCell<dim> &active, const Vector &relevant) const
    {
      std::array<L, dim> values;
      const double      *all = relevant.begin();
      for (unsigned int c = 0; c < dim; ++c)
        for (unsigned int a = 0; a < n_nodes; ++a)
          values[c][a] = all[active.node[a] + c];
      return values;
    }

    /// Sums up @p sum(nodal), where nodal is a number an unknown of the relevant set, and adds it to @p r. Compress afterwards.
    template <typename Sum>
    void
    add_nodal(Vector &r, const Sum &sum)
    {
      std::fill(nodal.begin(), nodal.end(), 0.);
      sum(nodal);
      r.add(index, nodal);
    }

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
      std::vector<dealii::types::global_dof_index> dofs;
    };

  private:
    std::vector<ActiveCell<dim>>                 cells;
    dealii::IndexSet                             relevant;
    std::vector<dealii::types::global_dof_index> index; ///< of each relevant unknown
    std::vector<double>                          nodal; ///< at relevant unknowns, while they are summed up
  };
} // namespace Stroma::Mpm
