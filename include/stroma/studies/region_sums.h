#pragma once

#include <stroma/studies/compare.h>
#include <stroma/studies/pairing.h>

namespace Stroma::Studies
{
  /// Parts of the scene that get norms of their own: name, and what belongs.
  using Regions = std::vector<std::pair<std::string, SceneGeometry::Region>>;

  /// What the places of this rank come to in one field, block by block: sums of squares in each region, and the largest values.
  class RegionSums
  {
  public:
    explicit RegionSums(std::size_t n_regions);

    /// Takes in the places that both cover. @param gradient of the field, or "" @param regions the same at each call
    void add(const FieldPair &field, const std::string &gradient, const Pairing &pairing, const Regions &regions);

    /// The norms over the places of all ranks; @p asked regions must hold some, else UserError. Collective.
    FieldComparison norms(const std::string &name, double time, const Regions &regions,
                          const std::vector<std::string> &asked, MPI_Comm comm) const;

  private:
    struct Sums
    {
      std::uint64_t n_places = 0;
      double        volume   = 0.;
      Norm          l2, h1, max; ///< squares, but for max
    };

    std::vector<Sums> sums;
    Peak              peak_a, peak_b;
    bool              has_gradient = false;
  };
} // namespace Stroma::Studies
