#pragma once

#include <stroma/base/parameters.h>
#include <stroma/shapes/shape.h>

#include <memory>

namespace Stroma::Shapes
{
  /// Declares and reads the entries of a shape in the current section. Throws UserError on all ranks. Collective.
  template <int dim>
  using Read = std::shared_ptr<const Shape<dim>> (*)(Parameters &p, MPI_Comm comm);

  /// The shapes that bodies of a scene may have, by name; 'box' is the first.
  template <int dim>
  std::vector<std::pair<std::string, Read<dim>>> table();

  /// Declares and reads a required place [m].
  template <int dim>
  dealii::Point<dim> read_point(Parameters &p, const std::string &entry, const std::string &meaning, double start);
} // namespace Stroma::Shapes
