#pragma once

#include <stroma/fem/unknowns.h>
#include <stroma/rigid/contact_set.h>

namespace Stroma::Fem
{
  /// The owned nodes of a mesh's boundary that are not held, with the integrals of their shape functions over it. Collective.
  template <int dim>
  std::vector<Rigid::ContactPoint<dim>> contact_points(const Scene<dim> &scene, const Settings<dim> &settings,
                                                       const Mesh<dim> &mesh, const Unknowns<dim> &unknowns);
} // namespace Stroma::Fem
