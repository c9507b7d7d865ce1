#pragma once

#include <stroma/fem/settings.h>
#include <stroma/shapes/shape.h>

#include <deal.II/fe/mapping.h>
#include <deal.II/grid/tria.h>

#include <memory>

namespace Stroma::Fem
{
  /// Makes the mesh of a single ball, ring or convex quadrilateral. False, and nothing made, if the shape is none of them.
  /// @param mapping of its cells @param n_splits of all of them that are still to be made
  template <int dim>
  bool make_fitted(const Shapes::Shape<dim> &shape, const Settings<dim> &settings,
                   dealii::Triangulation<dim> &triangulation, std::unique_ptr<dealii::Mapping<dim>> &mapping,
                   unsigned int &n_splits);
} // namespace Stroma::Fem
