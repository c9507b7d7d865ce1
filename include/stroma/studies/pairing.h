#pragma once

#include <stroma/studies/field_source.h>
#include <stroma/studies/norms.h>

namespace Stroma::Studies
{
  /// Values of A and B at one set of places at one time.
  class Pairing
  {
  public:
    /// @param fields whose values both sets hold side by side, with as many components as source @p a says
    Pairing(FieldSource &a, const std::vector<std::string> &fields, PlaceSet of_a, PlaceSet of_b);

    bool has(const std::string &name) const;

    /// One field's values: not a number where the one or the other has no material.
    FieldPair pair(const std::string &name) const;

    std::vector<Output::Field> known;
    PlaceSet                   places;  ///< with B's values
    std::vector<std::size_t>   covered; ///< by both
    std::uint64_t              uncovered_by_a = 0, uncovered_by_b = 0;

  private:
    void blank(std::vector<double> &values, std::size_t i, bool found) const;

    std::vector<double> values_a;
    std::vector<bool>   found_a;
    unsigned int        stride = 0;
  };
} // namespace Stroma::Studies
