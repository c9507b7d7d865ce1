#include <stroma/solvers/incomplete_cholesky.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <stdexcept>

namespace Stroma::Solvers
{
  struct IncompleteCholesky::Factor
  {
    // Neighbours have numbers near each other already, and an order for little fill makes the factor worse: twice the iterations.
    Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>> llt;
  };

  IncompleteCholesky::IncompleteCholesky(const SparseRows &upper)
  {
    const auto                  n = static_cast<Eigen::Index>(upper.length.size());
    Eigen::SparseMatrix<double> lower(n, n); // by columns
    lower.resizeNonZeros(static_cast<Eigen::Index>(upper.value.size()));
    for (Eigen::Index i = 0; i < n; ++i)
      lower.outerIndexPtr()[i + 1] = lower.outerIndexPtr()[i] + static_cast<int>(upper.length[i]);
    std::copy(upper.column.begin(), upper.column.end(), lower.innerIndexPtr());
    std::copy(upper.value.begin(), upper.value.end(), lower.valuePtr());
    const auto made = std::make_shared<Factor>();
    made->llt.compute(lower);
    if (made->llt.info() != Eigen::Success)
      throw std::runtime_error("no incomplete factor of the matrix");
    factor = made;
  }

  void
  IncompleteCholesky::vmult(Vector &y, const Vector &x) const
  {
    const auto                              n = factor->llt.rows();
    const Eigen::Map<const Eigen::VectorXd> values(x.begin(), n);
    Eigen::Map<Eigen::VectorXd>(y.begin(), n) = factor->llt.solve(values);
  }
} // namespace Stroma::Solvers
