#include "facet_tree.h"

#include <algorithm>
#include <limits>

namespace Stroma::Shapes
{
  namespace
  {
    /// Weights of the ends at the place of a segment that is nearest to X.
    std::array<double, 2>
    weights_at(const dealii::Point<2> &X, const Facet<2> &segment)
    {
      const auto &[a, b] = segment.corners;
      const double s     = std::clamp((X - a) * (b - a) / (b - a).norm_square(), 0., 1.);
      return {{1. - s, s}};
    }

    /// The same of a triangle's corners (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
    std::array<double, 3>
    weights_at(const dealii::Point<3> &X, const Facet<3> &triangle)
    {
      const auto &[a, b, c] = triangle.corners;
      const auto   ab = b - a, ac = c - a;
      const double d1 = ab * (X - a), d2 = ac * (X - a);
      if (d1 <= 0 && d2 <= 0)
        return {{1, 0, 0}};
      const double d3 = ab * (X - b), d4 = ac * (X - b);
      if (d3 >= 0 && d4 <= d3)
        return {{0, 1, 0}};
      const double vc = d1 * d4 - d3 * d2;
      if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return {{1 - d1 / (d1 - d3), d1 / (d1 - d3), 0}};
      const double d5 = ab * (X - c), d6 = ac * (X - c);
      if (d6 >= 0 && d5 <= d6)
        return {{0, 0, 1}};
      const double vb = d5 * d2 - d1 * d6;
      if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return {{1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)}};
      const double va = d3 * d6 - d5 * d4, s = d4 - d3, t = d5 - d6;
      if (va <= 0 && s >= 0 && t >= 0)
        return {{0, 1 - s / (s + t), s / (s + t)}};
      const double sum = va + vb + vc;
      return {{1 - vb / sum - vc / sum, vb / sum, vc / sum}};
    }

    template <int dim>
    std::vector<std::pair<dealii::BoundingBox<dim>, unsigned int>>
    leaves_of(const std::vector<Facet<dim>> &facets)
    {
      std::vector<std::pair<dealii::BoundingBox<dim>, unsigned int>> leaves;
      for (unsigned int f = 0; f < facets.size(); ++f)
        leaves.emplace_back(dealii::BoundingBox<dim>(
                              std::vector<dealii::Point<dim>>(facets[f].corners.begin(), facets[f].corners.end())),
                            f);
      return leaves;
    }
  } // namespace

  template <int dim>
  FacetTree<dim>::FacetTree(std::vector<Facet<dim>> all)
    : facets(std::move(all))
    , tree(leaves_of(facets))
  {}

  template <int dim>
  typename FacetTree<dim>::Found
  FacetTree<dim>::nearest(const dealii::Point<dim> &X) const
  {
    Found  best;
    double least = std::numeric_limits<double>::max();
    // Boxes come in the order of their distance: those beyond the best facet hold none that is nearer.
    for (auto leaf = tree.qbegin(boost::geometry::index::nearest(X, static_cast<unsigned int>(facets.size())));
         leaf != tree.qend() && boost::geometry::comparable_distance(X, leaf->first) <= least; ++leaf)
      {
        const auto        &facet   = facets[leaf->second];
        const auto         weights = weights_at(X, facet);
        dealii::Point<dim> place;
        for (unsigned int i = 0; i < dim; ++i)
          place += weights[i] * facet.corners[i];
        if (const double distance = (X - place).norm_square(); distance < least)
          {
            least = distance;
            best  = {leaf->second, weights, place};
          }
      }
    return best;
  }

  template class FacetTree<2>;
  template class FacetTree<3>;
} // namespace Stroma::Shapes
