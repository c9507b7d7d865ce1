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

  /// Those of all ranks, by rank. Collective.
  std::vector<Extent> all_extents(const Extent &mine, MPI_Comm comm);

  /// How well a rank knows a place: the lowest number of all ranks wins, the lowest rank among equals.
  using Rating               = std::uint64_t;
  constexpr Rating knows_not = std::numeric_limits<Rating>::max();

  /// Which ranks are asked for a place: all whose extent is near enough, or the nearest of them.
  enum class Asked
  {
    all,
    nearest
  };

  /**
   * Fills values and found of @p samples, places of this rank, by the ranks that may know them: those whose extent is
   * within @p reach [m] of the place. Nothing but the places and their values goes from rank to rank.
   *
   * @param mine around what this rank knows
   * @param answer rates a place and, unless it is knows_not, fills in its @p width values. Local.
   * Collective.
   */
  void ask_ranks(Samples &samples, unsigned int width, const Extent &mine, double reach, Asked asked,
                 const std::function<Rating(const Place &, double *)> &answer, MPI_Comm comm);
} // namespace Stroma::Output
