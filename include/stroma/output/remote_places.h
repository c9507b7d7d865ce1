#pragma once

#include <stroma/output/state_view.h>

#include <array>
#include <functional>
#include <limits>

namespace Stroma::Output
{
  /// A box in space that grows around what is put into it; empty at first.
  struct Extent
  {
    Place lower{{none, none, none}}, upper{{-none, -none, -none}};

    void add(const Place &X);
    /// How far @p X is outside, along the axis where that is most; 0 inside.
    double distance(const Place &X) const;

  private:
    static constexpr double none = std::numeric_limits<double>::max();
  };

  /// How well a rank knows a place: the lowest number of all ranks wins, the lowest rank among equals.
  using Rating               = std::uint64_t;
  constexpr Rating knows_not = std::numeric_limits<Rating>::max();

  /// The ranks that are asked for a place, in ascending order. Local.
  using WhoKnows = std::function<std::vector<unsigned int>(const Place &)>;

  /// Those whose extent is within @p reach [m] of the place. @param mine around what this rank knows. Collective.
  WhoKnows ranks_within(const Extent &mine, double reach, MPI_Comm comm);

  /**
   * Fills values and found of @p samples, places of this rank, by the ranks that may know them. Nothing but the places and
   * their values goes from rank to rank.
   *
   * @param answer rates a place and, unless it is knows_not, fills in its @p width values. Local.
   * Collective.
   */
  void ask_ranks(Samples &samples, unsigned int width, const WhoKnows &who,
                 const std::function<Rating(const Place &, double *)> &answer, MPI_Comm comm);
} // namespace Stroma::Output
