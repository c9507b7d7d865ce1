#pragma once

#include <stroma/studies/compare.h>

namespace Stroma::Studies
{
  /// The comparison as a table for people.
  std::string table_of(const Comparison &comparison);

  /// Leaves compare.json, compare.csv, profiles.csv (with lines) and difference.csv (the map, at most 200000 places) in
  /// @p folder, which it makes. Throws UserError on all ranks if they cannot be written. Collective.
  void write_report(const Comparison &comparison, const std::string &folder, MPI_Comm comm);
} // namespace Stroma::Studies
