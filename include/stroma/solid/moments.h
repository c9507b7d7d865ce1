#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>

namespace Stroma::Solid
{
  /// Volume and moments of points of equal standing, up to the second order.
  template <int dim>
  class Moments
  {
  public:
    void
    add(const double V, const dealii::Tensor<1, dim> &x)
    {
      zeroth += V;
      first += V * x;
      second += V * symmetrize(outer_product(x, x));
      ++n;
    }

    /// A box of the volume @p V about @p x with edges of these lengths.
    void
    add_box(const double V, const dealii::Tensor<1, dim> &x, const dealii::Tensor<1, dim> &edges)
    {
      add(V, x);
      for (unsigned int d = 0; d < dim; ++d)
        second[d][d] += V * edges[d] * edges[d] / 12.;
    }

    void
    add(const Moments &other)
    {
      zeroth += other.zeroth;
      first += other.first;
      second += other.second;
      n += other.n;
    }

    double
    volume() const
    {
      return zeroth;
    }

    /// How many points these are.
    unsigned int
    n_points() const
    {
      return n;
    }

    dealii::Tensor<1, dim>
    centroid() const
    {
      return first / zeroth;
    }

    /// Mean of (x - c) (x) (x - c) about the centroid c.
    dealii::SymmetricTensor<2, dim>
    covariance() const
    {
      return second / zeroth - symmetrize(outer_product(centroid(), centroid()));
    }

  private:
    double                          zeroth = 0.;
    dealii::Tensor<1, dim>          first;
    dealii::SymmetricTensor<2, dim> second;
    unsigned int                    n = 0;
  };
} // namespace Stroma::Solid
