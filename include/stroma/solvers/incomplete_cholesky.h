#pragma once

#include <stroma/base/types.h>
#include <stroma/solvers/operator.h>

#include <memory>

namespace Stroma::Solvers
{
  /**
   * L L^T like a symmetric positive definite matrix, L with as many entries in each column as that has, the largest ones (Lin &
   * More 1999, by Eigen). Of each rank's own unknowns: across ranks it knows of no coupling.
   */
  class IncompleteCholesky
  {
  public:
    /// @param upper triangle of the matrix between this rank's unknowns. Throws std::runtime_error where it has no factor.
    explicit IncompleteCholesky(const SparseRows &upper);

    /// y = (L L^T)^-1 x. Local.
    void vmult(Vector &y, const Vector &x) const;

  private:
    struct Factor;
    std::shared_ptr<const Factor> factor;
  };
} // namespace Stroma::Solvers
