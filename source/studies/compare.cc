#include <stroma/base/text.h>
#include <stroma/output/collective.h>
#include <stroma/studies/common_fields.h>
#include <stroma/studies/places.h>
#include <stroma/studies/region_sums.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Studies
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;

    constexpr std::size_t block_size = 65536; ///< places whose values of B are there at once

    /// The comparison while it is being made.
    class Comparing
    {
    public:
      Comparing(RunSource &a, FieldSource &b, const CompareOptions &options)
        : comm(a.comm)
        , a(a)
        , b(b)
        , options(options)
        , geometry(*a.geometry)
        , fields(common_fields(a, b, options))
        , asked(with_gradients(fields, a, b))
      {
        result.a     = a.name();
        result.b     = b.name();
        result.frame = geometry.frame;
        result.times = common_times(a, b, options);
        regions.emplace_back("all", [](const Place &, unsigned int) { return true; });
        for (unsigned int m = 0; m < geometry.frame.materials.size() && geometry.frame.materials.size() > 1; ++m)
          regions.emplace_back("material " + geometry.frame.materials[m],
                               [m](const Place &, const unsigned int material) { return material == m; });
        for (const auto &text : options.regions)
          regions.emplace_back(text, geometry.region(text));
        result.points = name_of_points();
      }

      Comparison
      run()
      {
        for (const double time : result.times)
          at(time);
        return std::move(result);
      }

    private:
      std::string
      name_of_points() const
      {
        const bool on_grid = options.points == CompareOptions::Points::grid;
        if (!options.grid.empty() && !on_grid)
          throw UserError("--grid", "it goes with --points grid; give that too or leave it out");
        if (b.own_places(result.times[0]).empty())
          return on_grid ? "grid" : "run";
        if (on_grid)
          throw UserError("--points", b.name() + " has places of its own; leave --points out");
        return "stored";
      }

      void
      at(const double time)
      {
        const PlaceSet mine = points_at(time);
        if (result.points == "run" && options.lines.empty())
          a.let_go(); // its values are there
        Sums sums;
        sums.fields.assign(fields.size(), RegionSums(regions.size()));
        sums.n_places = mine.samples.X.size();
        // B answers for a block at a time, so that its values are never there as a whole.
        const std::size_t n        = sums.n_places,
                          n_blocks = MPI::max(std::uint64_t((n + block_size - 1) / block_size), comm);
        for (std::size_t block = 0; block < n_blocks; ++block)
          add_block(pair(part_of(mine, std::min(n, block * block_size), std::min(n, (block + 1) * block_size)), time,
                         result.points == "run"),
                    time, sums);
        Output::throw_if_any(sums.not_finite, comm);
        count_places(sums);
        for (std::size_t f = 0; f < fields.size(); ++f)
          result.fields.push_back(sums.fields[f].norms(fields[f], time, regions, options.regions, comm));
        if (time == result.times.back())
          result.map = std::move(sums.map);
        sums.kept.name = points_name;
        std::vector<PlaceSet> kept{std::move(sums.kept)};
        for (const auto &line : options.lines)
          kept.push_back(add_profile(line, time));
        if (options.keep_b)
          result.kept.places.push_back(std::move(kept));
      }

      struct Sums
      {
        std::vector<RegionSums> fields;
        std::size_t             n_places  = 0;
        std::uint64_t           n_covered = 0, uncovered_by_a = 0, uncovered_by_b = 0;
        std::string             not_finite; ///< the first complaint
        DifferenceMap           map;
        PlaceSet                kept;
      };

      void
      add_block(const Pairing &pairing, const double time, Sums &sums)
      {
        sums.n_covered += pairing.covered.size();
        sums.uncovered_by_a += pairing.uncovered_by_a;
        sums.uncovered_by_b += pairing.uncovered_by_b;
        for (std::size_t f = 0; f < fields.size(); ++f)
          {
            const FieldPair field = pairing.pair(fields[f]);
            if (sums.not_finite.empty())
              sums.not_finite = not_finite(field, pairing, time);
            sums.fields[f].add(field, gradient_of(fields[f]), pairing, regions);
            if (f == 0 && time == result.times.back())
              add_to_map(field, pairing, time, sums.n_places, sums.map);
          }
        if (options.keep_b)
          append(pairing.places, sums.kept);
        result.kept.fields = pairing.known;
      }

      void
      count_places(const Sums &sums)
      {
        const std::uint64_t uncovered_by_a = MPI::sum(sums.uncovered_by_a, comm),
                            uncovered_by_b = MPI::sum(sums.uncovered_by_b, comm);
        result.n_places                    = MPI::sum(std::uint64_t(sums.n_places), comm);
        result.uncovered_by_a              = std::max<std::size_t>(result.uncovered_by_a, uncovered_by_a);
        result.uncovered_by_b              = std::max<std::size_t>(result.uncovered_by_b, uncovered_by_b);
        if (MPI::sum(sums.n_covered, comm) == 0)
          throw UserError("none of the " + std::to_string(result.n_places) + " places is covered by both: " + a.name() +
                          " misses " + std::to_string(uncovered_by_a) + ", " + b.name() + " misses " +
                          std::to_string(uncovered_by_b) + "; are they of one scene?");
      }

      /// Lines are short: all ranks get to know the whole profile. Returns the places with B's values.
      PlaceSet
      add_profile(const std::string &line, const double time)
      {
        const auto along = pair(line_at(line, time), time, false);
        Profile    profile{line, time, Output::gather_all(along.places.samples.X, comm), {}};
        for (const auto &name : fields)
          {
            const FieldPair mine = along.pair(name);
            profile.fields.push_back(
              {name, mine.components, Output::gather_all(mine.a, comm), Output::gather_all(mine.b, comm)});
          }
        result.profiles.push_back(std::move(profile));
        return along.places;
      }

      /// A norm over values that are none would be none, and look like a field that one of the two does not have.
      std::string
      not_finite(const FieldPair &field, const Pairing &pairing, const double time) const
      {
        for (const std::size_t i : pairing.covered)
          for (const auto &[size, source] :
               {std::make_pair(field.size_of_a(i), a.name()), {field.size_of_b(i), b.name()}})
            if (!std::isfinite(size))
              {
                const Place &X = pairing.places.samples.X[i];
                return source + ": the value of " + field.field + " at (" + brief(X[0]) + ", " + brief(X[1]) + ", " +
                       brief(X[2]) + ") m and t = " + brief(time) + " s is not finite, so there is no norm";
              }
        return "";
      }

      /// The places of the comparison, with A's values where these are its own points.
      PlaceSet
      points_at(const double time)
      {
        if (result.points == "run")
          return {points_name, a.own_samples(asked, time)};
        if (result.points == "grid")
          return lattice(geometry, options.grid, comm);
        return stored(points_name, time);
      }

      PlaceSet
      line_at(const std::string &line, const double time)
      {
        return result.points == "stored" ? stored(line, time) :
                                           line_places(line, geometry.frame.dimension, options.n_samples, comm);
      }

      PlaceSet
      stored(const std::string &name, const double time) const
      {
        std::vector<std::string> lines;
        for (auto &set : b.own_places(time))
          {
            if (set.name == name)
              {
                set.samples.values.clear();
                return set;
              }
            if (set.name != points_name)
              lines.push_back("'" + set.name + "'");
          }
        throw UserError("--line", b.name() + " has no values along '" + name + "'; it has " +
                                    (lines.empty() ? "no line" : join(lines, ", ")));
      }

      /// @param knows_a whether A's values are there
      Pairing
      pair(PlaceSet of_a, const double time, const bool knows_a)
      {
        PlaceSet of_b{of_a.name, {of_a.samples.X, of_a.samples.weight, of_a.samples.material, {}, {}}, of_a.first};
        b.sample(asked, time, of_b);
        if (!knows_a)
          a.sample(asked, time, of_a);
        return Pairing(a, asked, std::move(of_a), std::move(of_b));
      }

      /// @param n places that there will be at most
      static void
      add_to_map(const FieldPair &field, const Pairing &pairing, const double time, const std::size_t n,
                 DifferenceMap &map)
      {
        map.field = field.field;
        map.time  = time;
        map.X.reserve(n);
        for (auto *sizes : {&map.a, &map.b, &map.difference})
          sizes->reserve(n);
        for (const std::size_t i : pairing.covered)
          {
            map.X.push_back(pairing.places.samples.X[i]);
            map.a.push_back(field.size_of_a(i));
            map.b.push_back(field.size_of_b(i));
            map.difference.push_back(field.size_of_difference(i));
          }
      }

      MPI_Comm                 comm;
      RunSource               &a;
      FieldSource             &b;
      const CompareOptions    &options;
      const SceneGeometry     &geometry;
      std::vector<std::string> fields; ///< compared
      std::vector<std::string> asked;  ///< and their gradients, for the H1 norm
      Regions                  regions;
      Comparison               result;
    };
  } // namespace

  Comparison
  compare(RunSource &a, FieldSource &b, const CompareOptions &options)
  {
    return Comparing(a, b, options).run();
  }
} // namespace Stroma::Studies
