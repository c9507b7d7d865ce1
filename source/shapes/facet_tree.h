#pragma once

#include <stroma/shapes/shape.h>

#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <deal.II/boost_adaptors/bounding_box.h>
#include <deal.II/boost_adaptors/point.h>

namespace Stroma::Shapes
{
  /// Segments in the plane or triangles in space, found by place.
  template <int dim>
  class FacetTree
  {
  public:
    explicit FacetTree(std::vector<Facet<dim>> facets);

    /// The place of the facets that is nearest to a given one.
    struct Found
    {
      unsigned int            facet = 0;
      std::array<double, dim> weights{}; ///< of the facet's corners, which add up to 1; exactly 0 on its sides
      dealii::Point<dim>      place;
    };
    Found nearest(const dealii::Point<dim> &X) const;

    /// Calls visit(index) for each facet whose box meets @p box.
    template <typename Visit>
    void
    for_each_near(const dealii::BoundingBox<dim> &box, const Visit &visit) const
    {
      for (auto leaf = tree.qbegin(boost::geometry::index::intersects(box)); leaf != tree.qend(); ++leaf)
        visit(leaf->second);
    }

    const std::vector<Facet<dim>> facets;

  private:
    using Leaf = std::pair<dealii::BoundingBox<dim>, unsigned int>;
    boost::geometry::index::rtree<Leaf, boost::geometry::index::linear<16>> tree;
  };
} // namespace Stroma::Shapes
