#include "self_crossing.h"

#include "facet_tree.h"

#include <algorithm>
#include <set>

namespace Stroma::Shapes
{
  namespace
  {
    constexpr double touching = 1e-6; ///< over the size, of volumes over its cube

    /// Six times the volume of a tetrahedron, with its sign.
    double
    volume(const dealii::Point<3> &a, const dealii::Point<3> &b, const dealii::Point<3> &c, const dealii::Point<3> &d)
    {
      return dealii::cross_product_3d(b - a, c - a) * (d - a);
    }

    /// Where the line from @p p to @p q passes through a triangle's inside.
    std::optional<dealii::Point<3>>
    crossing(const dealii::Point<3> &p, const dealii::Point<3> &q, const Facet<3> &triangle)
    {
      const auto &[a, b, c] = triangle.corners;
      const double size     = std::max({p.distance(q), a.distance(b), b.distance(c), c.distance(a)});
      const double least    = touching * size * size * size;
      const double of_p = volume(a, b, c, p), of_q = volume(a, b, c, q);
      if (std::min(std::abs(of_p), std::abs(of_q)) < least || (of_p > 0.) == (of_q > 0.))
        return std::nullopt;
      const std::array<double, 3> round{{volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)}};
      const auto [lowest, highest] = std::minmax_element(round.begin(), round.end());
      if (*lowest<least && * highest> - least)
        return std::nullopt;
      return dealii::Point<3>(p + of_p / (of_p - of_q) * (q - p));
    }
  } // namespace

  std::optional<dealii::Point<3>>
  self_crossing(const Triangles &all)
  {
    std::vector<Facet<3>>                           facets;
    std::set<std::pair<unsigned int, unsigned int>> edges;
    for (const auto &corners : all.corners)
      {
        facets.push_back({{{all.vertices[corners[0]], all.vertices[corners[1]], all.vertices[corners[2]]}}});
        for (unsigned int i = 0; i < 3; ++i)
          edges.insert({std::minmax(corners[i], corners[(i + 1) % 3])});
      }
    const FacetTree<3> tree(std::move(facets));
    for (const auto &[from, to] : edges)
      {
        const auto                     &p = all.vertices[from], &q = all.vertices[to];
        std::optional<dealii::Point<3>> found;
        tree.for_each_near(dealii::BoundingBox<3>(std::vector<dealii::Point<3>>{p, q}), [&](const unsigned int f) {
          const auto &corners = all.corners[f];
          const auto  has     = [&](const unsigned int v) {
            return std::find(corners.begin(), corners.end(), v) != corners.end();
          };
          if (!found && !has(from) && !has(to))
            found = crossing(p, q, tree.facets[f]);
        });
        if (found)
          return found;
      }
    return std::nullopt;
  }
} // namespace Stroma::Shapes
