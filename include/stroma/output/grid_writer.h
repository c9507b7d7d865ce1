#pragma once

#include <stroma/base/types.h>
#include <stroma/output/file_units.h>
#include <stroma/output/vtu.h>

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/vector.h>

#include <string>
#include <vector>

namespace Stroma::Output
{
  /// A vector-valued nodal field (dim components) on the DoFHandler.
  struct NodalField
  {
    std::string   name;   ///< without its unit, for example "displacement"
    std::string   unit;   ///< in SI: "m"
    const Vector *values; ///< with ghosts for all locally relevant unknowns
  };

  /// A scalar nodal field on a DoFHandler of its own, over the same triangulation.
  template <int dim>
  struct ScalarNodalField
  {
    std::string                    name;   ///< without its unit, for example "pressure"
    std::string                    unit;   ///< in SI: "Pa"
    const Vector                  *values; ///< with ghosts for all locally relevant unknowns
    const dealii::DoFHandler<dim> *dof_handler;
  };

  /// A scalar on each cell.
  struct CellField
  {
    std::string                   name;   ///< without its unit, for example "von_mises"
    std::string                   unit;   ///< in SI: "Pa"
    const dealii::Vector<double> *values; ///< by active_cell_index()
  };

  /// Which file of a grid.
  struct GridFile
  {
    std::string  folder;
    unsigned int counter;
    FileUnits    units;
    FileNotes    notes; ///< what it says of itself
  };

  /// Bytes that it takes for a moment to write a linear cell: fields, patches, text. Measured: 700 on 256 x 256 x 26 cells.
  constexpr double memory_of_written_cell = 900.;

  /**
   * Writes the cells that carry unknowns (active_fe_index 0, so none with FE_Nothing) with nodal vectors and
   * scalars and cell scalars to <folder>/grid_<counter>.<rank>.vtu and the record grid_<counter>.pvtu. Elements of higher degree are
   * subdivided. Positions are those of the triangulation. Returns the record's file name without the folder.
   * Collective. Throws OutputError on all ranks if a file cannot be written, and removes what it has written.
   */
  template <int dim>
  std::string write_grid(const GridFile &file, const dealii::DoFHandler<dim> &dof_handler,
                         const std::vector<NodalField> &nodal, const std::vector<CellField> &cells,
                         const std::vector<ScalarNodalField<dim>> &scalars = {});
} // namespace Stroma::Output
