#include "facet_tree.h"
#include <stroma/shapes/triangulation.h>

#include <stroma/shapes/faceted.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace Stroma::Shapes
{
  template <int dim>
  Faceted<dim>::Faceted(std::vector<dealii::Point<dim>> of_vertices, std::vector<Corners> of_facets,
                        const bool is_of_file)
    : vertices(std::move(of_vertices))
    , corners(std::move(of_facets))
    , is_of_file(is_of_file)
    , box(vertices)
    , grain(1e-12 * box.get_boundary_points().first.distance(box.get_boundary_points().second))
  {
    std::vector<Facet<dim>> facets;
    for (const auto &c : corners)
      facets.push_back(facet(c));
    tree = std::make_unique<FacetTree<dim>>(std::move(facets));
    find_normals();
    find_moments();
  }

  template <int dim>
  Faceted<dim>::~Faceted() = default;

  template <int dim>
  Facet<dim>
  Faceted<dim>::facet(const Corners &c) const
  {
    Facet<dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      result.corners[i] = vertices[c[i]];
    return result;
  }

  template <int dim>
  void
  Faceted<dim>::find_normals()
  {
    vertex_normals.resize(vertices.size());
    std::map<std::array<unsigned int, 2>, dealii::Tensor<1, dim>> of_edges;
    const auto                                                    edge = [](const Corners &c, const unsigned int i) {
      const auto [low, high] = std::minmax(c[(i + 1) % dim], c[(i + 2) % dim]);
      return std::array<unsigned int, 2>{{low, high}};
    };
    for (unsigned int f = 0; f < corners.size(); ++f)
      {
        const auto &at     = tree->facets[f].corners;
        const auto  vector = tree->facets[f].area_vector();
        normals.push_back(vector / vector.norm());
        for (unsigned int i = 0; i < dim; ++i)
          {
            double weight = 1.;
            if (dim == 3)
              {
                const auto p = at[(i + 1) % dim] - at[i], q = at[(i + 2) % dim] - at[i];
                weight = std::acos(std::clamp(p * q / (p.norm() * q.norm()), -1., 1.));
                of_edges[edge(corners[f], i)] += normals[f];
              }
            vertex_normals[corners[f][i]] += weight * normals[f];
          }
      }
    if (dim == 3)
      for (const auto &c : corners)
        {
          edge_normals.emplace_back();
          for (unsigned int i = 0; i < dim; ++i)
            edge_normals.back()[i] = of_edges.at(edge(c, i));
        }
  }

  template <int dim>
  dealii::Tensor<1, dim>
  Faceted<dim>::pseudo_normal(const unsigned int f, const std::array<double, dim> &weights) const
  {
    const auto n_zero = std::count(weights.begin(), weights.end(), 0.);
    if (n_zero == 0)
      return normals[f];
    if (n_zero == dim - 1)
      return vertex_normals[corners[f][std::max_element(weights.begin(), weights.end()) - weights.begin()]];
    return edge_normals[f][std::find(weights.begin(), weights.end(), 0.) - weights.begin()];
  }

  template <int dim>
  Nearest<dim>
  Faceted<dim>::nearest(const dealii::Point<dim> &X) const
  {
    const auto                   found = tree->nearest(X);
    const dealii::Tensor<1, dim> d     = X - found.place;
    const dealii::Tensor<1, dim> N     = pseudo_normal(found.facet, found.weights);
    const double                 sign = d * N < 0. ? -1. : 1., away = d.norm();
    Nearest<dim>                 result;
    result.foot     = found.place;
    result.distance = sign * away;
    // Within a facet its normal is exact, beside an edge or a corner the direction from there, on it the mean of normals.
    if (std::count(found.weights.begin(), found.weights.end(), 0.) == 0)
      result.normal = normals[found.facet];
    else
      result.normal = away > grain ? sign / away * d : N / N.norm();
    return result;
  }

  template <int dim>
  bool
  Faceted<dim>::contains(const dealii::Point<dim> &X) const
  {
    return box.point_inside(X, 1e-12) && nearest(X).distance <= grain;
  }

  template <int dim>
  dealii::BoundingBox<dim>
  Faceted<dim>::bounding_box() const
  {
    return box;
  }

  template <int dim>
  Moments<dim>
  Faceted<dim>::moments() const
  {
    return all;
  }

  /// Sums over the simplices that the facets span with one place o; for vertices v of each, relative to o,
  ///   int X dV = V/(dim + 1) sum v,  int X X dV = V/((dim + 1)(dim + 2)) (sum v v + sum v sum v).
  template <int dim>
  void
  Faceted<dim>::find_moments()
  {
    const auto             o = box.center();
    dealii::Tensor<1, dim> first;
    for (const auto &f : tree->facets)
      {
        const double                    V = (f.corners[0] - o) * f.area_vector() / dim;
        dealii::Tensor<1, dim>          sum;
        dealii::SymmetricTensor<2, dim> squares;
        for (const auto &corner : f.corners)
          {
            sum += corner - o;
            squares += symmetrize(outer_product(corner - o, corner - o));
          }
        all.volume += V;
        first += V / (dim + 1) * sum;
        all.second += V / ((dim + 1) * (dim + 2)) * (squares + symmetrize(outer_product(sum, sum)));
      }
    const dealii::Tensor<1, dim> c = first / all.volume;
    all.centroid                   = o + c;
    all.second -= all.volume * symmetrize(outer_product(c, c));
  }

  template <int dim>
  std::vector<Facet<dim>>
  Faceted<dim>::facets(const double size) const
  {
    return split_to_size(tree->facets, size);
  }

  template class Faceted<2>;
  template class Faceted<3>;
} // namespace Stroma::Shapes
