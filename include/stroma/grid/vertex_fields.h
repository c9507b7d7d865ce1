#pragma once

#include <stroma/base/types.h>
#include <stroma/grid/background_grid.h>

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/hp/fe_collection.h>

namespace Stroma
{
  /// Linear elements on the cells of a background grid that carry unknowns: what shows its fields, by values at vertices.
  template <int dim>
  class VertexFields
  {
  public:
    /// For the grid's present unknowns. Collective.
    explicit VertexFields(const BackgroundGrid<dim> &grid);

    /// The field of unknowns @p nodal, at vertices, with ghosts. Collective.
    Vector values(const Vector &nodal) const;

  private:
    const BackgroundGrid<dim>          &grid;
    const dealii::hp::FECollection<dim> elements; // active, empty

  public:
    dealii::DoFHandler<dim> dofs;
  };
} // namespace Stroma
