#pragma once

#include <stroma/scene/region.h>

namespace Stroma
{
  /// A place whose motion is a result. Section `Probes`, one subsection each, with 'Where = nearest x, y'.
  template <int dim>
  struct Probe
  {
    std::string        name;
    dealii::Point<dim> place; ///< undeformed [m]
    std::string        where; ///< "file:line" of the place
  };

  /// Declares and reads section `Probes`. Throws UserError.
  template <int dim>
  std::vector<Probe<dim>> add_probes(Parameters &p, const SceneNames &names);
} // namespace Stroma
