#pragma once

#include <stroma/studies/field_source.h>

namespace Stroma::Studies
{
  /// The places of A's own points, or of what stands for them.
  inline const char *points_name = "points";

  /// This rank's share of the centres of a lattice of @p n cells along each axis (none: 64 in the plane, 32 in space) over the
  /// bodies' box, where there is material. Throws UserError.
  PlaceSet lattice(const SceneGeometry &geometry, std::vector<unsigned int> n, MPI_Comm comm);

  /// This rank's share of @p n places along the line "x, y : x, y" [m]. Throws UserError.
  PlaceSet line_places(const std::string &text, unsigned int dim, unsigned int n, MPI_Comm comm);

  /// Places [begin, end) of @p all.
  PlaceSet part_of(const PlaceSet &all, std::size_t begin, std::size_t end);

  /// Adds the places of @p part and their values to @p all.
  void append(const PlaceSet &part, PlaceSet &all);
} // namespace Stroma::Studies
