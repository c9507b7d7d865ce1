#pragma once

#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_vector.h>

namespace Stroma
{
  /// Distributed vector of every grid-based solve (Epetra underneath).
  using Vector = dealii::TrilinosWrappers::MPI::Vector;

  /// Distributed compressed-row matrix of every grid-based solve.
  using Matrix = dealii::TrilinosWrappers::SparseMatrix;
} // namespace Stroma
