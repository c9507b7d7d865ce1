#include <stroma/solvers/incomplete_cholesky.h>

#include <gtest/gtest.h>

#include <stdexcept>

using namespace Stroma;
using namespace Stroma::Solvers;

namespace
{
  /// A chain of springs between walls, 2 on the diagonal and -1 beside it, on each rank.
  SparseRows
  chain(const unsigned int n)
  {
    SparseRows rows;
    for (unsigned int i = 0; i < n; ++i)
      {
        rows.length.push_back(i + 1 < n ? 2 : 1);
        rows.column.push_back(i);
        rows.value.push_back(2.);
        if (i + 1 < n)
          {
            rows.column.push_back(i + 1);
            rows.value.push_back(-1.);
          }
      }
    return rows;
  }
} // namespace

/// Nothing fills in, so the factor is complete, of each rank's own part.
TEST(IncompleteCholesky, MpiIsExactForAChain)
{
  const unsigned int n = 50, rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  dealii::IndexSet   owned(n * dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD));
  owned.add_range(rank * n, (rank + 1) * n);
  Vector x(owned, MPI_COMM_WORLD), y(owned, MPI_COMM_WORLD);
  for (unsigned int i = 0; i < n; ++i)
    x.begin()[i] = 1.;
  IncompleteCholesky(chain(n)).vmult(y, x);
  for (unsigned int i = 0; i < n; ++i)
    EXPECT_NEAR(y.begin()[i], .5 * (i + 1.) * (n - i), 1e-10 * n * n);
}

TEST(IncompleteCholesky, KeepsThePatternOfWhatFillsIn)
{
  // An arrow: eliminating the first unknown would couple all others.
  SparseRows         rows;
  const unsigned int n = 5;
  for (unsigned int i = 0; i < n; ++i)
    {
      rows.length.push_back(i == 0 ? n : 1);
      for (unsigned int j = i; j < (i == 0 ? n : i + 1); ++j)
        {
          rows.column.push_back(j);
          rows.value.push_back(i == j ? 4. : 1.);
        }
    }
  Vector x(dealii::complete_index_set(n), MPI_COMM_SELF), y(x);
  x = 1.;
  IncompleteCholesky(rows).vmult(y, x);
  // Of the incomplete factor L: first column (2, .5, ...), the others sqrt(4 - .25) on the diagonal.
  EXPECT_NEAR(y[1], (1. - .5 * .5) / 3.75, 1e-12);
}
