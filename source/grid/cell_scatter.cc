#include <stroma/base/power.h>
#include <stroma/grid/cell_scatter.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Map.h>

#include <algorithm>
#include <array>

namespace Stroma
{
  template <int dim>
  CellScatter<dim>::CellScatter(Matrix &K, const dealii::IndexSet &relevant, const unsigned int n_nodes)
    : nodes_of_cell(n_nodes)
    , matrix(K.trilinos_matrix())
    , row(relevant.n_elements())
    , column(relevant.n_elements())
  {
    std::size_t i = 0;
    for (const auto unknown : relevant)
      {
        row[i]    = matrix.RowMap().LID(static_cast<int>(unknown));
        column[i] = matrix.ColMap().LID(static_cast<int>(unknown));
        ++i;
      }
  }

  template <int dim>
  bool
  CellScatter<dim>::add(const int *node, const dealii::FullMatrix<double> &K_cell)
  {
    return nodes_of_cell == power(2, dim) ? add_nodes<power(2, dim)>(node, K_cell) :
                                            add_nodes<power(3, dim)>(node, K_cell);
  }

  template <int dim>
  template <unsigned int n_nodes>
  bool
  CellScatter<dim>::add_nodes(const int *node, const dealii::FullMatrix<double> &K_cell)
  {
    // Places of all nodes' first columns in the rows of all nodes, found before anything is added.
    int                                 place[n_nodes][n_nodes];
    std::array<double *, n_nodes * dim> values;
    for (unsigned int a = 0; a < n_nodes; ++a)
      {
        if (row[node[a]] < 0)
          return false;
        int  n;
        int *columns;
        for (unsigned int i = 0; i < dim; ++i)
          matrix.ExtractMyRowView(row[node[a]] + i, n, values[a * dim + i], columns);
        for (unsigned int b = 0; b < n_nodes; ++b)
          {
            const int *found = std::lower_bound(columns, columns + n, column[node[b]]);
            if (columns + n - found < dim)
              return false;
            for (unsigned int j = 0; j < dim; ++j)
              if (found[j] != column[node[b] + j])
                return false;
            place[a][b] = found - columns;
          }
      }
    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int i = 0; i < dim; ++i)
        {
          double       *target = values[a * dim + i];
          const double *source = &K_cell(a * dim + i, 0);
          for (unsigned int b = 0; b < n_nodes; ++b)
            for (unsigned int j = 0; j < dim; ++j)
              target[place[a][b] + j] += source[b * dim + j];
        }
    return true;
  }

  template class CellScatter<2>;
  template class CellScatter<3>;
} // namespace Stroma
