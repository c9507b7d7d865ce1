#pragma once

#include <stroma/base/types.h>

#include <deal.II/base/index_set.h>
#include <deal.II/lac/full_matrix.h>

#include <vector>

namespace Stroma
{
  /**
   * Adds cell matrices straight into the compressed rows of a distributed matrix: the columns of a node are found once
   * for its `dim` rows, and by a search in the row itself instead of through global numbers.
   */
  template <int dim>
  class CellScatter
  {
  public:
    /// @param K matrix with its final pattern; must outlive this @param relevant locally relevant unknowns, node by node
    /// @param n_nodes of a cell: 2^dim or 3^dim
    CellScatter(Matrix &K, const dealii::IndexSet &relevant, unsigned int n_nodes);

    /// Adds @p K_cell (unknowns node by node) if all its unknowns are rows of this rank and present in each other's rows.
    /// Otherwise changes nothing and returns false. @p node place of each node's first unknown in the relevant set.
    bool add(const int *node, const dealii::FullMatrix<double> &K_cell);

  private:
    template <unsigned int n>
    bool add_nodes(const int *node, const dealii::FullMatrix<double> &K_cell);

    const unsigned int      nodes_of_cell;
    const Epetra_CrsMatrix &matrix;
    std::vector<int>        row, column; ///< local numbers of each relevant unknown, -1 if it has none
  };
} // namespace Stroma
