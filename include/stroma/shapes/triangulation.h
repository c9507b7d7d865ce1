#pragma once

#include <stroma/shapes/shape.h>

namespace Stroma::Shapes
{
  /// The longest edge of a facet [m].
  template <int dim>
  double longest_edge(const Facet<dim> &facet);

  /// A facet as @p n segments, or n^2 similar triangles.
  template <int dim>
  std::vector<Facet<dim>> split(const Facet<dim> &facet, unsigned int n);

  /// Facets as pieces with edges of at most @p size [m].
  template <int dim>
  std::vector<Facet<dim>> split_to_size(const std::vector<Facet<dim>> &facets, double size);

  /// The 20 triangles of the icosahedron in the ball of radius 1 about 0.
  std::vector<Facet<3>> unit_icosahedron();
} // namespace Stroma::Shapes
