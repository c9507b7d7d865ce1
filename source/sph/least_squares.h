#pragma once

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/point.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace Stroma::Sph
{
  /**
   * Values at scattered nodes, continued to any place by moving least squares: a polynomial fitted to the nodes within
   * a radius, weighted by (1 - q)^4 (1 + 4 q), q the distance over the radius. It is of degree 2 where there are twice
   * as many nodes as it has coefficients, if need be (in corners) within a wider radius, and else linear. Results
   * depend on the order of the nodes in the last digits only.
   */
  template <int dim>
  class LeastSquares
  {
  public:
    static constexpr int          any_group = -1;
    static constexpr unsigned int max_width = 8;
    static constexpr double       widening  = 1.5; ///< of the radius, where there are too few nodes

    /// @param domain its extent along a periodic direction is the period [m]
    /// @param width numbers a node, at most max_width
    LeastSquares(double radius, const dealii::BoundingBox<dim> &domain, const std::array<bool, dim> &periodic,
                 unsigned int width);

    /// A node that counts for places of its group only, or for all with any_group.
    void add(const dealii::Point<dim> &x, int group, const double *values);

    /// To be called after the last add().
    void finish();

    /// The group of the node that stands at @p x, any_group if there is none.
    int group_at(const dealii::Point<dim> &x) const;

    /// Values at @p x, and gradients: dim numbers a value. False if there are too few nodes.
    bool fit(const dealii::Point<dim> &x, int group, double *values, double *gradients) const;

  private:
    struct Node
    {
      dealii::Point<dim> x;
      int                group;
      std::size_t        first; ///< place in `all_values`
    };
    struct Weighted
    {
      dealii::Tensor<1, dim> offset; ///< over the radius of the search
      double                 weight;
      std::size_t            first;
    };

    void add_images();
    void find(const dealii::Point<dim> &x, int group, double within) const;
    template <int n_terms>
    bool solve(double within, double *values, double *gradients) const;

    std::array<int, dim>
    bucket_of(const dealii::Point<dim> &x) const
    {
      std::array<int, dim> bucket;
      for (unsigned int d = 0; d < dim; ++d)
        bucket[d] = static_cast<int>(std::floor((x[d] - lower[d]) / bucket_size));
      return bucket;
    }

    /// -1 outside.
    std::int64_t
    index(const std::array<int, dim> &bucket) const
    {
      std::int64_t result = 0;
      for (int d = dim - 1; d >= 0; --d)
        {
          if (bucket[d] < 0 || bucket[d] >= n_buckets[d])
            return -1;
          result = result * n_buckets[d] + bucket[d];
        }
      return result;
    }

    const double                   radius, bucket_size; ///< [m]
    const dealii::BoundingBox<dim> domain;
    const std::array<bool, dim>    periodic;
    const unsigned int             width;

    std::vector<Node>             nodes; ///< bucket by bucket after finish()
    std::vector<double>           all_values;
    dealii::Point<dim>            lower; ///< of the buckets
    std::array<int, dim>          n_buckets{};
    std::vector<std::size_t>      first_node; ///< of each bucket, and the end
    mutable std::vector<Weighted> near;
  };
} // namespace Stroma::Sph
