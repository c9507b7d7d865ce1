#pragma once

#include <stroma/fem/settings.h>

namespace Stroma::Fem
{
  /// Throws UserError, at entry 'Cells' or @p where, if @p n_cells cells of the scene's material would need more memory than
  /// there is. Collective.
  template <int dim>
  void check_size(const Scene<dim> &scene, const Settings<dim> &settings, double n_cells, const std::string &where);

  /// The same for the cells of the settings before any is made, with the refinements by error estimate.
  template <int dim>
  void check_size(const Scene<dim> &scene, const Settings<dim> &settings);
} // namespace Stroma::Fem
