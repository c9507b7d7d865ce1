#include "least_squares.h"

#include <stroma/particles/periodic.h>

#include <algorithm>

namespace Stroma::Sph
{
  using Particles::folded;

  namespace
  {
    /// How near a node is to the place where it stands, over the radius.
    constexpr double same_place = 1e-6;

    /// What elimination must leave of a diagonal entry: less, and nodes do not determine a polynomial (all on a line).
    constexpr double least_pivot = 1e-8;

    /// 1, x, y, (z,) x^2, x y, y^2, ...
    template <int dim, int n>
    std::array<double, n>
    monomials(const dealii::Tensor<1, dim> &x)
    {
      std::array<double, n> p;
      p[0] = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        p[1 + d] = x[d];
      if constexpr (n > dim + 1)
        for (unsigned int a = 0, k = dim + 1; a < dim; ++a)
          for (unsigned int b = a; b < dim; ++b)
            p[k++] = x[a] * x[b];
      return p;
    }

    /// A = L L^T in place, of its lower half. False if A is not well positive definite.
    template <int n>
    bool
    factorise(std::array<std::array<double, n>, n> &A)
    {
      for (unsigned int k = 0; k < n; ++k)
        {
          const double given = A[k][k];
          for (unsigned int m = 0; m < k; ++m)
            A[k][k] -= A[k][m] * A[k][m];
          if (!(A[k][k] > least_pivot * given))
            return false;
          A[k][k] = std::sqrt(A[k][k]);
          for (unsigned int i = k + 1; i < n; ++i)
            {
              for (unsigned int m = 0; m < k; ++m)
                A[i][k] -= A[i][m] * A[k][m];
              A[i][k] /= A[k][k];
            }
        }
      return true;
    }

    /// b = (L L^T)^-1 b.
    template <int n>
    void
    substitute(const std::array<std::array<double, n>, n> &L, std::array<double, n> &b)
    {
      for (unsigned int i = 0; i < n; ++i)
        {
          for (unsigned int m = 0; m < i; ++m)
            b[i] -= L[i][m] * b[m];
          b[i] /= L[i][i];
        }
      for (int i = n - 1; i >= 0; --i)
        {
          for (int m = i + 1; m < n; ++m)
            b[i] -= L[m][i] * b[m];
          b[i] /= L[i][i];
        }
    }
  } // namespace

  template <int dim>
  LeastSquares<dim>::LeastSquares(const double radius, const dealii::BoundingBox<dim> &domain,
                                  const std::array<bool, dim> &periodic, const unsigned int width)
    : radius(radius)
    , bucket_size(widening * radius)
    , domain(domain)
    , periodic(periodic)
    , width(width)
  {}

  template <int dim>
  void
  LeastSquares<dim>::add(const dealii::Point<dim> &x, const int group, const double *values)
  {
    nodes.push_back({folded<dim>(x, domain, periodic), group, all_values.size()});
    all_values.insert(all_values.end(), values, values + width);
  }

  /// Copies of the nodes near a periodic face beyond the face opposite.
  template <int dim>
  void
  LeastSquares<dim>::add_images()
  {
    for (unsigned int d = 0; d < dim; ++d)
      {
        if (!periodic[d])
          continue;
        const std::size_t n = nodes.size();
        for (std::size_t i = 0; i < n; ++i)
          for (const double sign : {-1., 1.})
            {
              Node image = nodes[i];
              image.x[d] += sign * domain.side_length(d);
              if (image.x[d] > domain.lower_bound(d) - bucket_size && image.x[d] < domain.upper_bound(d) + bucket_size)
                nodes.push_back(image);
            }
      }
  }

  template <int dim>
  void
  LeastSquares<dim>::finish()
  {
    add_images();
    dealii::Point<dim> upper;
    for (unsigned int d = 0; d < dim; ++d)
      {
        lower[d] = std::numeric_limits<double>::max();
        upper[d] = std::numeric_limits<double>::lowest();
        for (const Node &node : nodes)
          {
            lower[d] = std::min(lower[d], node.x[d]);
            upper[d] = std::max(upper[d], node.x[d]);
          }
        n_buckets[d] = nodes.empty() ? 0 : static_cast<int>((upper[d] - lower[d]) / bucket_size) + 1;
      }
    std::size_t n = 1;
    for (const int along : n_buckets)
      n *= along;
    first_node.assign(n + 1, 0);
    for (const Node &node : nodes)
      ++first_node[index(bucket_of(node.x)) + 1];
    for (std::size_t b = 0; b < n; ++b)
      first_node[b + 1] += first_node[b];
    std::vector<Node>        sorted(nodes.size());
    std::vector<std::size_t> next(first_node);
    for (const Node &node : nodes)
      sorted[next[index(bucket_of(node.x))]++] = node;
    nodes = std::move(sorted);
  }

  template <int dim>
  void
  LeastSquares<dim>::find(const dealii::Point<dim> &x, const int group, const double within) const
  {
    constexpr unsigned int n_around = dim == 2 ? 9 : 27;
    near.clear();
    const auto centre = bucket_of(x);
    for (unsigned int k = 0; k < n_around; ++k)
      {
        auto bucket = centre;
        for (unsigned int d = 0, rest = k; d < dim; ++d, rest /= 3)
          bucket[d] += static_cast<int>(rest % 3) - 1;
        const auto b = index(bucket);
        if (b < 0)
          continue;
        for (std::size_t i = first_node[b]; i < first_node[b + 1]; ++i)
          {
            const Node  &node   = nodes[i];
            const auto   offset = (node.x - x) / within;
            const double q      = offset.norm();
            if (q < 1. && (node.group == group || node.group == any_group))
              near.push_back({offset, std::pow(1. - q, 4) * (1. + 4. * q), node.first});
          }
      }
  }

  template <int dim>
  int
  LeastSquares<dim>::group_at(const dealii::Point<dim> &x) const
  {
    const auto place  = folded<dim>(x, domain, periodic);
    const auto bucket = index(bucket_of(place));
    if (bucket >= 0)
      for (std::size_t i = first_node[bucket]; i < first_node[bucket + 1]; ++i)
        if (nodes[i].group != any_group && nodes[i].x.distance(place) < same_place * radius)
          return nodes[i].group;
    return any_group;
  }

  template <int dim>
  template <int n_terms>
  bool
  LeastSquares<dim>::solve(const double within, double *values, double *gradients) const
  {
    std::array<std::array<double, n_terms>, n_terms>   A{};
    std::array<std::array<double, n_terms>, max_width> b{};
    for (const Weighted &node : near)
      {
        const auto p = monomials<dim, n_terms>(node.offset);
        for (unsigned int i = 0; i < n_terms; ++i)
          {
            const double weighted = node.weight * p[i];
            for (unsigned int k = 0; k <= i; ++k)
              A[i][k] += weighted * p[k];
            for (unsigned int k = 0; k < width; ++k)
              b[k][i] += weighted * all_values[node.first + k];
          }
      }
    if (!factorise<n_terms>(A))
      return false;
    for (unsigned int k = 0; k < width; ++k)
      {
        substitute<n_terms>(A, b[k]);
        values[k] = b[k][0];
        for (unsigned int d = 0; d < dim; ++d)
          gradients[k * dim + d] = b[k][1 + d] / within;
      }
    return true;
  }

  template <int dim>
  bool
  LeastSquares<dim>::fit(const dealii::Point<dim> &x, const int group, double *values, double *gradients) const
  {
    constexpr int n_linear = dim + 1, n_quadratic = (dim + 1) * (dim + 2) / 2;
    const auto    place = folded<dim>(x, domain, periodic);
    for (const double within : {radius, bucket_size})
      {
        find(place, group, within);
        if (near.size() >= 2 * n_quadratic && solve<n_quadratic>(within, values, gradients))
          return true;
      }
    return near.size() >= n_linear && solve<n_linear>(bucket_size, values, gradients);
  }

  template class LeastSquares<2>;
  template class LeastSquares<3>;
} // namespace Stroma::Sph
