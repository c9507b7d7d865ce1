#pragma once

#include <stroma/base/types.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/lac/full_matrix.h>

#include <cstdint>
#include <vector>

namespace Stroma::Solvers
{
  /// Rows of a sparse matrix, one behind the other.
  struct SparseRows
  {
    std::vector<std::uint64_t> length, column;
    std::vector<double>        value;
  };

  /// A symmetric positive definite operator of which not more is known than how it acts. All calls are collective.
  class Operator
  {
  public:
    virtual ~Operator() = default;

    /// y = A x; both fully distributed, with the same layout.
    virtual void vmult(Vector &y, const Vector &x) const = 0;

    /// The diagonal of A, all of it positive.
    virtual void diagonal(Vector &d) const = 0;

    /// A matrix like A, of which multigrid is made; valid until the next call.
    virtual const Matrix &approximation() = 0;

    /// Upper triangle of a symmetric positive definite matrix like A between the unknowns of this rank, numbered as they are in its
    /// part of a vector; of which an incomplete factor is made; valid until the next call. Not all operators have one.
    virtual const SparseRows &
    own_block()
    {
      AssertThrow(false, dealii::ExcNotImplemented());
      static const SparseRows none;
      return none;
    }

    /// Solves the rows that hold only their diagonal, into x, and takes them out of b; elsewhere x = 0.
    virtual void
    solve_decoupled(Vector &x, Vector & /*b*/) const
    {
      x = 0.;
    }

    /// Whether A brings a multigrid method of its own, which needs no matrix.
    virtual bool
    has_multigrid() const
    {
      return false;
    }
    /// Makes it fit what A is now. Throws where that cannot be, on all ranks or some.
    virtual void
    set_up_multigrid()
    {
      AssertThrow(false, dealii::ExcNotImplemented());
    }
    /// y = about A^-1 x, a symmetric positive definite function of x; held unknowns stay 0.
    virtual void
    apply_multigrid(Vector & /*y*/, const Vector & /*x*/) const
    {
      AssertThrow(false, dealii::ExcNotImplemented());
    }

    /// Whether A has unknowns that the approximation leaves out: the last ones of one rank, a few that are coupled with many.
    virtual bool
    has_border() const
    {
      return false;
    }
    /// Of that rank: a dense matrix like A of these; empty on others.
    virtual dealii::FullMatrix<double>
    border() const
    {
      return dealii::FullMatrix<double>();
    }

    /// What tells one operator from another, for a preconditioner that is kept.
    virtual const void *
    identity() const
    {
      return this;
    }
  };
} // namespace Stroma::Solvers
