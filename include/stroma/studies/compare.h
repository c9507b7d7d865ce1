#pragma once

#include <stroma/studies/field_source.h>
#include <stroma/studies/norms.h>

namespace Stroma::Studies
{
  /// What is compared, where and when.
  struct CompareOptions
  {
    enum class Points
    {
      run, ///< A's own points, or those of a stored reference
      grid ///< a lattice over the bodies' bounding box, where there is material
    };

    std::vector<std::string>  fields;            ///< with or without unit; empty: all that both have
    std::vector<double>       times;             ///< [s]; empty: all that both have
    bool                      only_last = false; ///< the last of the common times
    Points                    points    = Points::run;
    std::vector<unsigned int> grid;              ///< cells along each axis; empty: 64 in the plane, 32 in space
    std::vector<std::string>  regions;           ///< besides all and the materials, lengths in m
    std::vector<std::string>  lines;             ///< "x, y : x, y" [m]
    unsigned int              n_samples = 101;   ///< places along a line
    bool                      keep_b    = false; ///< keep B's values, for write_reference()
  };

  struct RegionNorms
  {
    std::string region;
    std::size_t n_places = 0;
    double      volume   = 0.; ///< [m^3]
    Norm        l2, h1, max;   ///< h1 of displacement and velocity: not a number if a gradient is unknown
  };

  struct Peak
  {
    double value = 0.; ///< the largest size; of a number, that number with its sign
    Place  X{};
    bool   is_known = false;
  };

  /// One field at one time.
  struct FieldComparison
  {
    std::string              field;
    double                   time = 0.; ///< [s]
    std::vector<RegionNorms> regions;   ///< the first is "all"
    Peak                     peak_a, peak_b;
  };

  /// One line at one time: values of A and B, not a number where there is none.
  struct Profile
  {
    std::string            line;
    double                 time = 0.; ///< [s]
    std::vector<Place>     X;
    std::vector<FieldPair> fields;
  };

  /// B's values at the places of the comparison, what a stored reference is made of.
  struct KeptValues
  {
    std::vector<Output::Field> fields;
    std::vector<std::vector<PlaceSet>>
      places; ///< of this rank, of each time, with values: not a number where B has no material
  };

  /// The first field at the last time at each place of this rank, for a picture.
  struct DifferenceMap
  {
    std::string         field;
    double              time = 0.;
    std::vector<Place>  X;
    std::vector<double> a, b, difference; ///< sizes
  };

  struct Comparison
  {
    std::string                  a, b; ///< names of the sources
    SceneFrame                   frame;
    std::string                  points; ///< "run", "grid" or "stored"
    std::vector<double>          times;  ///< [s]
    std::size_t                  n_places       = 0;
    std::size_t                  uncovered_by_a = 0, uncovered_by_b = 0; ///< largest numbers of all times
    std::vector<FieldComparison> fields;                                 ///< time by time
    std::vector<Profile>         profiles;
    DifferenceMap                map;
    KeptValues                   kept;
  };

  /// Names of all fields that a comparison may have, with their units.
  std::vector<std::string> comparable_fields();

  /// The name of a field with its unit, if it is known without it: "displacement" -> "displacement_m".
  std::string full_field_name(const std::string &name);

  /**
   * Differences of run @p a from @p b: at matching times (equal up to 1e-9 relative), at the same undeformed places, each
   * relative to B and weighted by the undeformed volume that the place stands for. Places that one of them does not cover
   * are left out and counted. The result is the same on all ranks, but for what is said to be of one. Throws UserError: no time or field in common, nothing
   * covered, a value that is not finite, a region without places. Collective.
   */
  Comparison compare(RunSource &a, FieldSource &b, const CompareOptions &options);
} // namespace Stroma::Studies
