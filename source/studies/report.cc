#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/output/collective.h>
#include <stroma/output/text_file.h>
#include <stroma/studies/report.h>
#include <stroma/studies/text_table.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

namespace Stroma::Studies
{
  namespace
  {
    using Json = nlohmann::ordered_json; // which writes what is not finite as null

    constexpr std::size_t most_map_places = 200000;

    double
    peak_difference(const FieldComparison &field)
    {
      return std::abs(field.peak_a.value) / std::abs(field.peak_b.value) - 1.; // the largest may be of either sign
    }

    Json
    json_of(const Norm &norm)
    {
      return {{"relative", norm.relative()}, {"difference", norm.difference}, {"reference", norm.reference}};
    }

    Json
    json_of(const FieldComparison &field)
    {
      Json json = {{"field", field.field},
                   {"time_s", field.time},
                   {"peak",
                    {{"a", field.peak_a.value},
                     {"a_place_m", field.peak_a.X},
                     {"b", field.peak_b.value},
                     {"b_place_m", field.peak_b.X},
                     {"relative_difference", peak_difference(field)}}},
                   {"regions", Json::array()}};
      for (const auto &region : field.regions)
        json["regions"].push_back({{"region", region.region},
                                   {"places", region.n_places},
                                   {"volume_m3", region.volume},
                                   {"L2", json_of(region.l2)},
                                   {"H1", json_of(region.h1)},
                                   {"max", json_of(region.max)}});
      return json;
    }

    std::string
    json_text(const Comparison &comparison)
    {
      Json json = {{"a", comparison.a},
                   {"b", comparison.b},
                   {"title", comparison.frame.title},
                   {"points", comparison.points},
                   {"times_s", comparison.times},
                   {"places", comparison.n_places},
                   {"uncovered_by_a", comparison.uncovered_by_a},
                   {"uncovered_by_b", comparison.uncovered_by_b},
                   {"fields", Json::array()}};
      for (const auto &field : comparison.fields)
        json["fields"].push_back(json_of(field));
      return json.dump(2) + "\n";
    }

    Rows
    rows_of(const Comparison &comparison, const char *format)
    {
      Rows rows = {{"time_s", "field", "region", "places", "L2_relative", "H1_relative", "max_relative", "peak_a",
                    "peak_b", "peak_difference"}};
      for (const auto &field : comparison.fields)
        for (const auto &region : field.regions)
          {
            const bool all = &region == &field.regions.front();
            rows.push_back({text_of(format, field.time), field.field, region.region, std::to_string(region.n_places),
                            text_of(format, region.l2.relative()), text_of(format, region.h1.relative()),
                            text_of(format, region.max.relative()), all ? text_of(format, field.peak_a.value) : "",
                            all ? text_of(format, field.peak_b.value) : "",
                            all ? text_of(format, peak_difference(field)) : ""});
          }
      return rows;
    }

    std::string
    component_name(const FieldPair &field, const unsigned int c)
    {
      if (field.components == 1)
        return field.field;
      if (field.components <= 3)
        return field.field + "_" + "xyz"[c];
      if (field.components == 6)
        return field.field + "_" + std::vector<std::string>{"xx", "yy", "zz", "xy", "xz", "yz"}[c];
      const unsigned int dim = field.components == 4 ? 2 : 3;
      return field.field + "_" + "xyz"[c / dim] + "xyz"[c % dim];
    }

    std::string
    coordinates(const Place &X)
    {
      return Output::to_text(X[0]) + "," + Output::to_text(X[1]) + "," + Output::to_text(X[2]);
    }

    /// "" where there is no value.
    std::string
    value_text(const double value)
    {
      return std::isnan(value) ? "" : Output::to_text(value);
    }

    std::string
    profiles_text(const std::vector<Profile> &profiles)
    {
      std::string text = "line,time_s,distance_m,x_m,y_m,z_m";
      for (const auto &field : profiles.front().fields)
        for (unsigned int c = 0; c < field.components; ++c)
          for (const std::string of : {"_a", "_b"})
            text += "," + component_name(field, c) + of;
      text += '\n';
      for (const auto &profile : profiles)
        for (std::size_t i = 0; i < profile.X.size(); ++i)
          {
            const auto  &X = profile.X[i], &start = profile.X.front();
            const double distance = std::hypot(X[0] - start[0], X[1] - start[1], X[2] - start[2]);
            text += Output::csv_cell(profile.line) + "," + Output::to_text(profile.time) + "," +
                    Output::to_text(distance) + "," + coordinates(X);
            for (const auto &field : profile.fields)
              for (unsigned int c = 0; c < field.components; ++c)
                text += "," + value_text(field.a[i * field.components + c]) + "," +
                        value_text(field.b[i * field.components + c]);
            text += '\n';
          }
      return text;
    }

    /// Every so many of the places of all ranks in a row, known to all.
    DifferenceMap
    thinned(const DifferenceMap &mine, const MPI_Comm comm)
    {
      namespace MPI     = dealii::Utilities::MPI;
      std::size_t first = 0, n = 0; // of this rank, and all
      const auto  sizes = MPI::all_gather(comm, mine.X.size());
      for (std::size_t rank = 0; rank < sizes.size(); ++rank)
        {
          first += rank < MPI::this_mpi_process(comm) ? sizes[rank] : 0;
          n += sizes[rank];
        }
      const std::size_t stride = std::max<std::size_t>((n + most_map_places - 1) / most_map_places, 1);
      DifferenceMap     part{mine.field, mine.time, {}, {}, {}, {}};
      for (std::size_t i = (stride - first % stride) % stride; i < mine.X.size(); i += stride)
        {
          part.X.push_back(mine.X[i]);
          part.a.push_back(mine.a[i]);
          part.b.push_back(mine.b[i]);
          part.difference.push_back(mine.difference[i]);
        }
      return {mine.field,
              mine.time,
              Output::gather_all(part.X, comm),
              Output::gather_all(part.a, comm),
              Output::gather_all(part.b, comm),
              Output::gather_all(part.difference, comm)};
    }

    std::string
    map_text(const DifferenceMap &map)
    {
      std::string text = "x_m,y_m,z_m," + map.field + "_a," + map.field + "_b," + map.field + "_difference\n";
      for (std::size_t i = 0; i < map.X.size(); ++i)
        text += coordinates(map.X[i]) + "," + Output::to_text(map.a[i]) + "," + Output::to_text(map.b[i]) + "," +
                Output::to_text(map.difference[i]) + "\n";
      return text;
    }
  } // namespace

  std::string
  table_of(const Comparison &comparison)
  {
    std::string text = comparison.a + " against " + comparison.b + ": " + counted(comparison.n_places, "place") + " (" +
                       comparison.points + ")";
    for (const auto &[n, name] : {std::make_pair(comparison.uncovered_by_a, comparison.a),
                                  std::make_pair(comparison.uncovered_by_b, comparison.b)})
      if (n > 0)
        text += ", " + grouped(n) + " not covered by " + name;
    text += "\n" + aligned(rows_of(comparison, "%.4g"));
    for (const auto &field : comparison.fields)
      if (field.time == comparison.times.back())
        text += "  largest " + field.field + ": " + brief(field.peak_a.value) + " at (" + brief(field.peak_a.X[0]) +
                ", " + brief(field.peak_a.X[1]) + ", " + brief(field.peak_a.X[2]) + ") m; reference " +
                brief(field.peak_b.value) + " at (" + brief(field.peak_b.X[0]) + ", " + brief(field.peak_b.X[1]) +
                ", " + brief(field.peak_b.X[2]) + ") m\n";
    return text;
  }

  void
  write_report(const Comparison &comparison, const std::string &folder, const MPI_Comm comm)
  {
    const auto map = thinned(comparison.map, comm);
    on_root(comm, [&] {
      std::error_code code;
      std::filesystem::create_directories(folder, code);
      if (!std::filesystem::is_directory(folder, code))
        throw UserError("--output " + folder, "the folder cannot be made; choose another");
      if (std::filesystem::exists(folder + "/compare.json", code))
        std::filesystem::remove(folder + "/profiles.csv", code); // of an earlier comparison
      Output::write_atomically(folder + "/compare.json", json_text(comparison));
      Output::write_atomically(folder + "/compare.csv", csv(rows_of(comparison, "%.12g")));
      Output::write_atomically(folder + "/difference.csv", map_text(map));
      if (!comparison.profiles.empty())
        Output::write_atomically(folder + "/profiles.csv", profiles_text(comparison.profiles));
    });
  }
} // namespace Stroma::Studies
