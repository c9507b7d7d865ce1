#include <stroma/base/formula.h>
#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/studies/compare.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace Stroma::Studies
{
  namespace
  {
    const char      *points_name = "points";

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
    check_places(const std::string &where, const double n)
    {
      constexpr double per_place = 200.; // place, weight, material and the values of a few fields of both sides
      Memory::require_here(n * per_place, where, Memory::about(n) + " places of comparison");
    }

    PlaceSet
    lattice(const SceneGeometry &geometry, std::vector<unsigned int> n)
    {
      const auto        &frame = geometry.frame;
      const unsigned int dim   = frame.dimension;
      if (n.empty())
        n.assign(dim, dim == 2 ? 64 : 32);
      if (n.size() != dim || std::count(n.begin(), n.end(), 0u) > 0)
        throw UserError("the grid of places needs " + std::to_string(dim) + " positive numbers of cells, one an axis");
      n.resize(3, 1);
      check_places("the grid of places", double(n[0]) * n[1] * n[2]);
      PlaceSet places{points_name, {}};
      double   volume = frame.thickness;
      for (unsigned int d = 0; d < dim; ++d)
        volume *= (frame.upper[d] - frame.lower[d]) / n[d];
      for (unsigned int k = 0; k < n[2]; ++k)
        for (unsigned int j = 0; j < n[1]; ++j)
          for (unsigned int i = 0; i < n[0]; ++i)
            {
              Place                             X{};
              const std::array<unsigned int, 3> index{{i, j, k}};
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
    line_places(const std::string &text, const unsigned int dim, const unsigned int n)
    {
      check_places("--samples", n);
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
          throw UserError("--line", "'" + text + "' was given with " + std::to_string(n) + " places; it must be '" + place +
                                      " : " + place + "', two different places in m, with at least 2 samples");
        }
      PlaceSet places{text, {}};
      for (unsigned int i = 0; i < n; ++i)
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
    part_of(const std::vector<double> &values, const unsigned int stride, const unsigned int first, const unsigned int n)
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
            const bool in_a = found_a.empty() || found_a[i], in_b = places.samples.found.empty() || places.samples.found[i];
            uncovered_by_a += !in_a;
            uncovered_by_b += !in_b;
            if (in_a && in_b)
              covered.push_back(i);
            blank(values_a, i, in_a);
            blank(places.samples.values, i, in_b);
          }
      }

      bool has(const std::string &name) const { return contains(names_of(known), name); }

      FieldPair pair(const std::string &name) const
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

      std::vector<SampledField> known;
      PlaceSet                  places; ///< with B's values
      std::vector<std::size_t>  covered; ///< by both
      std::size_t               uncovered_by_a = 0, uncovered_by_b = 0;

    private:
      void blank(std::vector<double> &values, const std::size_t i, const bool found) const
      {
        if (!found)
          std::fill_n(values.begin() + i * stride, stride, unknown);
      }

      std::vector<double> values_a;
      std::vector<bool>   found_a;
      unsigned int        stride = 0;
    };

    /// The comparison while it is being made.
    class Comparing
    {
    public:
      Comparing(RunSource &a, FieldSource &b, const CompareOptions &options)
        : a(a)
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

      Comparison run()
      {
        for (const double time : result.times)
          at(time);
        return std::move(result);
      }

    private:
      std::string name_of_points() const
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

      void at(const double time)
      {
        const auto pairing = pair(points_at(time), time);
        check_finite(pairing, time);
        result.n_places       = pairing.places.samples.X.size();
        result.uncovered_by_a = std::max(result.uncovered_by_a, pairing.uncovered_by_a);
        result.uncovered_by_b = std::max(result.uncovered_by_b, pairing.uncovered_by_b);
        if (pairing.covered.empty())
          throw UserError("none of the " + std::to_string(result.n_places) + " places is covered by both: " + a.name() +
                          " misses " + std::to_string(pairing.uncovered_by_a) + ", " + b.name() + " misses " +
                          std::to_string(pairing.uncovered_by_b) + "; are they of one scene?");
        for (const auto &name : fields)
          result.fields.push_back(compare_field(pairing, name, time));
        if (time == result.times.back())
          result.map = map_of(pairing.pair(fields[0]), pairing, time);
        std::vector<PlaceSet> kept{pairing.places};
        for (const auto &line : options.lines)
          {
            const auto along = pair(line_at(line, time), time);
            result.profiles.push_back({line, time, along.places.samples.X, {}});
            for (const auto &name : fields)
              result.profiles.back().fields.push_back(along.pair(name));
            kept.push_back(along.places);
          }
        if (options.keep_b)
          {
            result.kept.fields = pairing.known;
            result.kept.places.push_back(kept);
          }
      }

      /// A norm over values that are none would be none, and look like a field that one of the two does not have.
      void check_finite(const Pairing &pairing, const double time) const
      {
        for (const auto &name : fields)
          {
            const FieldPair field = pairing.pair(name);
            for (const std::size_t i : pairing.covered)
              for (const auto &[size, source] : {std::make_pair(field.size_of_a(i), a.name()), {field.size_of_b(i), b.name()}})
                if (!std::isfinite(size))
                  {
                    const Place &X = pairing.places.samples.X[i];
                    throw UserError(source + ": the value of " + name + " at (" + brief(X[0]) + ", " + brief(X[1]) + ", " +
                                    brief(X[2]) + ") m and t = " + brief(time) + " s is not finite, so there is no norm");
                  }
          }
      }

      /// The places of the comparison, with A's values where these are its own points.
      PlaceSet points_at(const double time)
      {
        if (result.points == "run")
          return {points_name, a.own_samples(asked, time)};
        if (result.points == "grid")
          return lattice(geometry, options.grid);
        return stored(points_name, time);
      }

      PlaceSet line_at(const std::string &line, const double time)
      {
        return result.points == "stored" ? stored(line, time) :
                                           line_places(line, geometry.frame.dimension, options.n_samples);
      }

      PlaceSet stored(const std::string &name, const double time) const
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

      Pairing pair(PlaceSet of_a, const double time)
      {
        PlaceSet of_b{of_a.name, of_a.samples};
        of_b.samples.values.clear();
        b.sample(asked, time, of_b);
        if (of_a.samples.values.empty())
          a.sample(asked, time, of_a);
        return Pairing(a, asked, std::move(of_a), std::move(of_b));
      }

      FieldComparison compare_field(const Pairing &pairing, const std::string &name, const double time) const
      {
        const auto     &samples = pairing.places.samples;
        FieldComparison one{name, time, {}, {}, {}};
        const FieldPair field = pairing.pair(name);
        const auto      gradient     = gradients.find(name);
        const bool      has_gradient = gradient != gradients.end() && pairing.has(gradient->second);
        const FieldPair slope        = has_gradient ? pairing.pair(gradient->second) : FieldPair();
        for (const auto &[region, holds] : regions)
          {
            std::vector<std::size_t> places;
            RegionNorms              norms;
            for (const std::size_t i : pairing.covered)
              if (holds(samples.X[i], samples.material[i]))
                {
                  places.push_back(i);
                  norms.volume += samples.weight[i];
                }
            if (places.empty() && contains(options.regions, region))
              throw UserError("--region", "'" + region + "' holds none of the places of comparison; its lengths are in m, enlarge it or move it into the bodies");
            norms.region   = region;
            norms.n_places = places.size();
            norms.l2       = l2_norm(field, samples.weight, places);
            norms.max      = max_norm(field, places);
            norms.h1       = has_gradient ? l2_norm(slope, samples.weight, places) : Norm{unknown, unknown};
            one.regions.push_back(norms);
          }
        find_peaks(field, pairing, one);
        return one;
      }

      static void find_peaks(const FieldPair &field, const Pairing &pairing, FieldComparison &one)
      {
        for (const std::size_t i : pairing.covered)
          {
            const auto take = [&](Peak &peak, const double size, const double number) {
              if (size > std::abs(peak.value) || i == pairing.covered.front())
                peak = {field.components == 1 ? number : size, pairing.places.samples.X[i]};
            };
            take(one.peak_a, field.size_of_a(i), field.a[i * field.components]);
            take(one.peak_b, field.size_of_b(i), field.b[i * field.components]);
          }
      }

      static DifferenceMap map_of(const FieldPair &field, const Pairing &pairing, const double time)
      {
        DifferenceMap map{field.field, time, {}, {}, {}, {}};
        for (const std::size_t i : pairing.covered)
          {
            map.X.push_back(pairing.places.samples.X[i]);
            map.a.push_back(field.size_of_a(i));
            map.b.push_back(field.size_of_b(i));
            map.difference.push_back(field.size_of_difference(i));
          }
        return map;
      }

      RunSource                                                   &a;
      FieldSource                                                 &b;
      const CompareOptions                                        &options;
      const SceneGeometry                                         &geometry;
      std::vector<std::string>                                     fields; ///< compared
      std::vector<std::string>                                     asked;  ///< and their gradients, for the H1 norm
      std::vector<std::pair<std::string, SceneGeometry::Region>>   regions;
      Comparison                                                   result;
    };
  } // namespace

  std::vector<std::string>
  comparable_fields()
  {
    return {"displacement_m", "displacement_gradient",   "velocity_m_per_s", "velocity_gradient_per_s",
            "von_mises_Pa",   "pressure_Pa", "cauchy_stress_Pa"};
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
