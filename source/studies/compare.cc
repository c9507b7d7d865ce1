#include <stroma/base/formula.h>
#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/output/collective.h>
#include <stroma/studies/compare.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace Stroma::Studies
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;

    const char           *points_name = "points";
    constexpr std::size_t block_size  = 65536; ///< places whose values of B are there at once

    /// The fields that have an H1 semi norm, and their gradients.
    const std::map<std::string, std::string> gradients = {{"displacement_m", "displacement_gradient"},
                                                          {"velocity_m_per_s", "velocity_gradient_per_s"}};

    bool
    contains(const std::vector<std::string> &names, const std::string &name)
    {
      return std::find(names.begin(), names.end(), name) != names.end();
    }

    /// Whether a source knows its values at @p time.
    bool
    knows(const std::vector<double> &times, const double time)
    {
      return times.empty() || std::any_of(times.begin(), times.end(), [&](const double t) {
               return std::abs(t - time) <= 1e-9 * std::max(std::abs(t), std::abs(time));
             });
    }

    std::string
    in_words(const FieldSource &source)
    {
      std::vector<std::string> texts;
      for (const double time : source.times())
        texts.push_back(shortest(time));
      return source.name() + " has " + (texts.empty() ? "any time" : join(texts, ", ") + " s");
    }

    std::vector<double>
    common_times(const FieldSource &a, const FieldSource &b, const CompareOptions &options)
    {
      std::vector<double> times;
      for (const double time : options.times.empty() ? a.times() : options.times)
        if (knows(a.times(), time) && knows(b.times(), time))
          times.push_back(time);
        else if (!options.times.empty())
          throw UserError("there is no state at " + shortest(time) + " s in both: " + in_words(a) + ", " + in_words(b) +
                          "; choose times that both have");
      if (times.empty())
        throw UserError("the two have no time in common: " + in_words(a) + ", " + in_words(b) +
                        "; set 'Output/Fields every' so that both keep states at the same times");
      if (options.only_last)
        times.erase(times.begin(), times.end() - 1);
      return times;
    }

    std::vector<std::string>
    common_fields(FieldSource &a, FieldSource &b, const CompareOptions &options)
    {
      const auto               of_a = names_of(a.fields()), of_b = names_of(b.fields());
      std::vector<std::string> common;
      for (const auto &name : of_a)
        if (contains(of_b, name) && std::none_of(gradients.begin(), gradients.end(),
                                                 [&](const auto &gradient) { return gradient.second == name; }))
          common.push_back(name);
      if (common.empty())
        throw UserError(a.name() + " has the fields " + join(of_a, ", ") + "; " + b.name() + " has none of them but " +
                        join(of_b, ", "));
      std::vector<std::string> asked;
      for (const auto &name : options.fields)
        asked.push_back(full_field_name(name));
      for (const auto &name : asked)
        for (const auto &[names, source] : {std::make_pair(of_a, &a), std::make_pair(of_b, &b)})
          if (!contains(names, name))
            throw UserError(source->name() + " has no field '" + shown(name) + "'; both have: " + join(common, ", "));
      return asked.empty() ? common : asked;
    }

    /// Throws UserError if the samples at @p n places would not fit in the memory.
    void
    check_places(const std::string &where, const double n, const MPI_Comm comm)
    {
      constexpr double per_place = 200.; // place, weight, material and the values of a few fields of both sides
      Memory::require(comm, n * per_place, where, Memory::about(n) + " places of comparison");
    }

    /// This rank's part of @p n things in a row.
    std::pair<std::size_t, std::size_t>
    share_of_rank(const std::size_t n, const MPI_Comm comm)
    {
      const std::size_t rank = MPI::this_mpi_process(comm), n_ranks = MPI::n_mpi_processes(comm);
      return {n * rank / n_ranks, n * (rank + 1) / n_ranks};
    }

    PlaceSet
    lattice(const SceneGeometry &geometry, std::vector<unsigned int> n, const MPI_Comm comm)
    {
      const auto        &frame = geometry.frame;
      const unsigned int dim   = frame.dimension;
      if (n.empty())
        n.assign(dim, dim == 2 ? 64 : 32);
      if (n.size() != dim || std::count(n.begin(), n.end(), 0u) > 0)
        throw UserError("the grid of places needs " + std::to_string(dim) + " positive numbers of cells, one an axis");
      n.resize(3, 1);
      check_places("the grid of places", double(n[0]) * n[1] * n[2], comm);
      PlaceSet places{points_name, {}};
      double   volume = frame.thickness;
      for (unsigned int d = 0; d < dim; ++d)
        volume *= (frame.upper[d] - frame.lower[d]) / n[d];
      const auto [begin, end] = share_of_rank(std::size_t(n[0]) * n[1] * n[2], comm);
      for (std::size_t cell = begin; cell < end; ++cell)
        {
          Place                            X{};
          const std::array<std::size_t, 3> index{{cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]}};
          for (unsigned int d = 0; d < dim; ++d)
            X[d] = frame.lower[d] + (index[d] + .5) / n[d] * (frame.upper[d] - frame.lower[d]);
          if (const auto material = geometry.material_at(X))
            {
              places.samples.X.push_back(X);
              places.samples.weight.push_back(volume);
              places.samples.material.push_back(*material);
            }
        }
      return places;
    }

    PlaceSet
    line_places(const std::string &text, const unsigned int dim, const unsigned int n, const MPI_Comm comm)
    {
      check_places("--samples", n, comm);
      const auto                         ends = split(text, ':');
      std::vector<std::array<double, 3>> X;
      try
        {
          for (const auto &end : ends)
            {
              const auto parts = split(end, ',');
              if (parts.size() != dim)
                throw UserError("wrong number of coordinates");
              X.push_back({});
              for (unsigned int d = 0; d < dim; ++d)
                if (!plain_number(parts[d], X.back()[d]))
                  throw UserError("not a number");
            }
          if (X.size() != 2 || X[0] == X[1] || n < 2)
            throw UserError("no line");
        }
      catch (const std::exception &)
        {
          const std::string place = dim == 2 ? "x, y" : "x, y, z";
          throw UserError("--line", "'" + text + "' was given with " + std::to_string(n) + " places; it must be '" +
                                      place + " : " + place + "', two different places in m, with at least 2 samples");
        }
      PlaceSet   places{text, {}};
      const auto share = share_of_rank(n, comm);
      for (std::size_t i = share.first; i < share.second; ++i)
        {
          const double s = static_cast<double>(i) / (n - 1);
          Place        place{};
          for (unsigned int d = 0; d < dim; ++d)
            place[d] = (1 - s) * X[0][d] + s * X[1][d];
          places.samples.X.push_back(place);
        }
      return places;
    }

    /// Component blocks of each field out of values side by side.
    std::vector<double>
    part_of(const std::vector<double> &values, const unsigned int stride, const unsigned int first,
            const unsigned int n)
    {
      std::vector<double> part;
      part.reserve(values.size() / stride * n);
      for (std::size_t i = 0; i < values.size(); i += stride)
        part.insert(part.end(), values.begin() + i + first, values.begin() + i + first + n);
      return part;
    }

    /// Values of A and B at one set of places at one time.
    class Pairing
    {
    public:
      Pairing(FieldSource &a, const std::vector<std::string> &fields, PlaceSet of_a, PlaceSet of_b)
        : places(std::move(of_b))
        , values_a(std::move(of_a.samples.values))
        , found_a(std::move(of_a.samples.found))
      {
        for (const auto &name : fields)
          known.push_back({name, n_components(a, {name})});
        for (const auto &field : known)
          stride += field.components;
        for (std::size_t i = 0; i < places.samples.X.size(); ++i)
          {
            const bool in_a = found_a.empty() || found_a[i],
                       in_b = places.samples.found.empty() || places.samples.found[i];
            uncovered_by_a += !in_a;
            uncovered_by_b += !in_b;
            if (in_a && in_b)
              covered.push_back(i);
            blank(values_a, i, in_a);
            blank(places.samples.values, i, in_b);
          }
      }

      bool
      has(const std::string &name) const
      {
        return contains(names_of(known), name);
      }

      FieldPair
      pair(const std::string &name) const
      {
        unsigned int first = 0;
        for (const auto &field : known)
          {
            if (field.name == name)
              return {name, field.components, part_of(values_a, stride, first, field.components),
                      part_of(places.samples.values, stride, first, field.components)};
            first += field.components;
          }
        throw dealii::ExcInternalError();
      }

      std::vector<Output::Field> known;
      PlaceSet                   places;  ///< with B's values
      std::vector<std::size_t>   covered; ///< by both
      std::uint64_t              uncovered_by_a = 0, uncovered_by_b = 0;

    private:
      void
      blank(std::vector<double> &values, const std::size_t i, const bool found) const
      {
        if (!found)
          std::fill_n(values.begin() + i * stride, stride, unknown);
      }

      std::vector<double> values_a;
      std::vector<bool>   found_a;
      unsigned int        stride = 0;
    };

    /// Places [begin, end) of @p all.
    PlaceSet
    part_of(const PlaceSet &all, const std::size_t begin, const std::size_t end)
    {
      const auto cut = [&](const auto &whole, const std::size_t width = 1) {
        return whole.empty() ?
                 whole :
                 std::decay_t<decltype(whole)>(whole.begin() + begin * width, whole.begin() + end * width);
      };
      const auto &samples = all.samples;
      return {all.name,
              {cut(samples.X),
               cut(samples.weight),
               cut(samples.material),
               cut(samples.values, samples.X.empty() ? 1 : samples.values.size() / samples.X.size()),
               {}},
              begin};
    }

    void
    append(const PlaceSet &part, PlaceSet &all)
    {
      const auto add = [](const auto &from, auto &to) { to.insert(to.end(), from.begin(), from.end()); };
      add(part.samples.X, all.samples.X);
      add(part.samples.weight, all.samples.weight);
      add(part.samples.material, all.samples.material);
      add(part.samples.values, all.samples.values);
    }

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
        , asked(fields)
      {
        result.a     = a.name();
        result.b     = b.name();
        result.frame = geometry.frame;
        result.times = common_times(a, b, options);
        for (const auto &[name, gradient] : gradients)
          if (contains(fields, name) && !contains(fields, gradient) && contains(names_of(a.fields()), gradient) &&
              contains(names_of(b.fields()), gradient))
            asked.push_back(gradient);
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
        Sums           sums;
        sums.fields.resize(fields.size());
        for (auto &field : sums.fields)
          field.regions.resize(regions.size());
        // B answers for a block at a time, so that its values are never there as a whole.
        const std::size_t n        = mine.samples.X.size(),
                          n_blocks = MPI::max(std::uint64_t((n + block_size - 1) / block_size), comm);
        for (std::size_t block = 0; block < n_blocks; ++block)
          add_block(pair(part_of(mine, std::min(n, block * block_size), std::min(n, (block + 1) * block_size)), time,
                         result.points == "run"),
                    time, sums);
        Output::throw_if_any(sums.not_finite, comm);
        count_places(n, sums);
        for (std::size_t f = 0; f < fields.size(); ++f)
          result.fields.push_back(norms_of(fields[f], time, sums.fields[f]));
        if (time == result.times.back())
          result.map = std::move(sums.map);
        sums.kept.name = points_name;
        std::vector<PlaceSet> kept{std::move(sums.kept)};
        for (const auto &line : options.lines)
          kept.push_back(add_profile(line, time));
        if (options.keep_b)
          result.kept.places.push_back(std::move(kept));
      }

      /// What the places of this rank come to, of one field in one region: sums of squares, and the largest.
      struct RegionSums
      {
        std::uint64_t n_places = 0;
        double        volume   = 0.;
        Norm          l2, h1, max;
      };

      struct FieldSums
      {
        std::vector<RegionSums> regions;
        Peak                    peak_a, peak_b;
        bool                    has_gradient = false;
      };

      struct Sums
      {
        std::vector<FieldSums> fields;
        std::uint64_t          n_covered = 0, uncovered_by_a = 0, uncovered_by_b = 0;
        std::string            not_finite; ///< the first complaint
        DifferenceMap          map;
        PlaceSet               kept;
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
            add_field(field, pairing, sums.fields[f]);
            if (f == 0 && time == result.times.back())
              add_to_map(field, pairing, time, sums.map);
          }
        if (options.keep_b)
          append(pairing.places, sums.kept);
        result.kept.fields = pairing.known;
      }

      void
      count_places(const std::uint64_t n, const Sums &sums)
      {
        const std::uint64_t uncovered_by_a = MPI::sum(sums.uncovered_by_a, comm),
                            uncovered_by_b = MPI::sum(sums.uncovered_by_b, comm);
        result.n_places                    = MPI::sum(n, comm);
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

      void
      add_field(const FieldPair &field, const Pairing &pairing, FieldSums &sums) const
      {
        const auto &samples   = pairing.places.samples;
        const auto  gradient  = gradients.find(field.field);
        sums.has_gradient     = gradient != gradients.end() && pairing.has(gradient->second);
        const FieldPair slope = sums.has_gradient ? pairing.pair(gradient->second) : FieldPair();
        for (std::size_t r = 0; r < regions.size(); ++r)
          {
            std::vector<std::size_t> places;
            for (const std::size_t i : pairing.covered)
              if (regions[r].second(samples.X[i], samples.material[i]))
                {
                  places.push_back(i);
                  sums.regions[r].volume += samples.weight[i];
                }
            sums.regions[r].n_places += places.size();
            sums.regions[r].l2.add_squares(l2_norm(field, samples.weight, places));
            sums.regions[r].max.take_larger(max_norm(field, places));
            if (sums.has_gradient)
              sums.regions[r].h1.add_squares(l2_norm(slope, samples.weight, places));
          }
        for (const std::size_t i : pairing.covered)
          {
            const auto take = [&](Peak &peak, const double size, const double number) {
              if (size > std::abs(peak.value) || !peak.is_known)
                peak = {field.components == 1 ? number : size, samples.X[i], true};
            };
            take(sums.peak_a, field.size_of_a(i), field.a[i * field.components]);
            take(sums.peak_b, field.size_of_b(i), field.b[i * field.components]);
          }
      }

      /// Of all ranks.
      FieldComparison
      norms_of(const std::string &name, const double time, const FieldSums &sums) const
      {
        FieldComparison one{name, time, {}, largest(sums.peak_a), largest(sums.peak_b)};
        for (std::size_t r = 0; r < regions.size(); ++r)
          {
            const RegionSums &mine = sums.regions[r];
            RegionNorms       norms;
            norms.region   = regions[r].first;
            norms.n_places = MPI::sum(mine.n_places, comm);
            norms.volume   = MPI::sum(mine.volume, comm);
            if (norms.n_places == 0 && contains(options.regions, norms.region))
              throw UserError(
                "--region",
                "'" + norms.region +
                  "' holds none of the places of comparison; its lengths are in m, enlarge it or move it into the bodies");
            norms.l2  = root_of_sum(mine.l2);
            norms.h1  = sums.has_gradient ? root_of_sum(mine.h1) : Norm{unknown, unknown};
            norms.max = {MPI::max(mine.max.difference, comm), MPI::max(mine.max.reference, comm)};
            one.regions.push_back(norms);
          }
        return one;
      }

      Norm
      root_of_sum(const Norm &squares) const
      {
        return {std::sqrt(MPI::sum(squares.difference, comm)), std::sqrt(MPI::sum(squares.reference, comm))};
      }

      /// The largest of the ranks' peaks; of equal ones that of the lowest rank.
      Peak
      largest(const Peak &mine) const
      {
        Peak best;
        for (const auto &of_rank : MPI::all_gather(comm, std::vector<double>{mine.is_known ? 1. : 0., mine.value,
                                                                             mine.X[0], mine.X[1], mine.X[2]}))
          if (of_rank[0] > 0. && (!best.is_known || std::abs(of_rank[1]) > std::abs(best.value)))
            best = {of_rank[1], {{of_rank[2], of_rank[3], of_rank[4]}}, true};
        return best;
      }

      static void
      add_to_map(const FieldPair &field, const Pairing &pairing, const double time, DifferenceMap &map)
      {
        map.field = field.field;
        map.time  = time;
        for (const std::size_t i : pairing.covered)
          {
            map.X.push_back(pairing.places.samples.X[i]);
            map.a.push_back(field.size_of_a(i));
            map.b.push_back(field.size_of_b(i));
            map.difference.push_back(field.size_of_difference(i));
          }
      }

      MPI_Comm                                                   comm;
      RunSource                                                 &a;
      FieldSource                                               &b;
      const CompareOptions                                      &options;
      const SceneGeometry                                       &geometry;
      std::vector<std::string>                                   fields; ///< compared
      std::vector<std::string>                                   asked;  ///< and their gradients, for the H1 norm
      std::vector<std::pair<std::string, SceneGeometry::Region>> regions;
      Comparison                                                 result;
    };
  } // namespace

  std::vector<std::string>
  comparable_fields()
  {
    return {"displacement_m", "displacement_gradient", "velocity_m_per_s", "velocity_gradient_per_s",
            "von_mises_Pa",   "pressure_Pa",           "cauchy_stress_Pa"};
  }

  std::string
  full_field_name(const std::string &name)
  {
    for (const auto &known : {"displacement_m", "velocity_m_per_s", "von_mises_Pa", "pressure_Pa", "cauchy_stress_Pa"})
      if (std::string(known).rfind(name + "_m", 0) == 0 || std::string(known).rfind(name + "_Pa", 0) == 0)
        return known;
    return name;
  }

  Comparison
  compare(RunSource &a, FieldSource &b, const CompareOptions &options)
  {
    return Comparing(a, b, options).run();
  }
} // namespace Stroma::Studies
