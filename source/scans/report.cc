#include <stroma/base/text.h>
#include <stroma/output/text_file.h>
#include <stroma/scans/report.h>

#include <nlohmann/json.hpp>

#include <cstdio>
#include <numeric>

namespace Stroma::Scans
{
  namespace
  {
    using ReportJson = nlohmann::ordered_json;

    template <typename Number>
    std::string
    along_xyz(const Number &number)
    {
      return number(0) + " x " + number(1) + " x " + number(2);
    }

    std::string
    per_cent(const double share)
    {
      char text[32];
      std::snprintf(text, sizeof(text), "%.4g %%", 100 * share);
      return text;
    }

    std::string
    fixed(const double value, const int digits)
    {
      char text[32];
      std::snprintf(text, sizeof(text), "%.*f", digits, value);
      return text;
    }

    double
    quantile(const std::vector<double> &sorted, const double share)
    {
      return sorted[static_cast<std::size_t>(share * (sorted.size() - 1))];
    }

    /// The share of the largest piece, or what is not in it where that is too little to be seen in per cent.
    std::string
    share_of_largest(const std::vector<std::size_t> &pieces)
    {
      const auto n = std::accumulate(pieces.begin(), pieces.end(), std::size_t(0)), others = n - pieces.front();
      if (others > 0 && others < 5e-5 * n)
        return "all of it but " + counted(others, "voxel");
      return per_cent(double(pieces.front()) / n) + " of it";
    }

    std::string
    text_of(const MaterialShare &material)
    {
      std::string text = "  " + material.name + ": " + per_cent(material.fraction) + " of the volume; " +
                         counted(material.pieces.size(), "piece") + ", the largest " +
                         share_of_largest(material.pieces);
      if (material.fraction_merged != material.fraction)
        text += "; with merged voxels " + per_cent(material.fraction_merged);
      if (!material.thickness.empty())
        text += "; thickness " + brief(1e6 * quantile(material.thickness, .1)) + " / " +
                brief(1e6 * quantile(material.thickness, .5)) + " / " + brief(1e6 * quantile(material.thickness, .9)) +
                " um (10, 50, 90 % of its ridge)";
      return text + "\n";
    }

    std::string
    text_of(const Segmentation &segmentation)
    {
      std::string text = join(segmentation.report, "\n") + "\n";
      for (const auto &material : segmentation.materials)
        text += text_of(material);
      const auto &loose = segmentation.loose;
      text += segmentation.is_periodic ?
                "  pieces that touch no support are not counted in periodic scenes\n" :
                "  all materials together: " + counted(loose.n, "piece") + ", " +
                  (loose.n_loose == 0 ? (loose.n == 1 ? "which touches a support\n" : "each touches a support\n") :
                                        grouped(loose.n_loose) + " of them touch no support (" +
                                          per_cent(loose.share_loose) + " of the material)\n");
      if (segmentation.overlap)
        {
          text += "  overlap with " + segmentation.overlap->file +
                  (segmentation.overlap->remark.empty() ? "" : " (" + segmentation.overlap->remark + ")") + ":";
          for (const auto &[name, overlap] : segmentation.overlap->of_material)
            text += (name == segmentation.overlap->of_material.front().first ? " " : "; ") + name + " Dice " +
                    fixed(overlap.dice(), 4) + ", Jaccard " + fixed(overlap.jaccard(), 4);
          text += "\n";
        }
      return text;
    }

    ReportJson
    json_of(const Segmentation &segmentation)
    {
      ReportJson json = {{"body", segmentation.body},
                         {"corner_m", segmentation.corner},
                         {"thresholds", segmentation.thresholds},
                         {"materials", ReportJson::array()}};
      for (std::size_t i = 0; i < segmentation.materials.size(); ++i)
        {
          const auto &material = segmentation.materials[i];
          ReportJson  one      = {{"name", material.name},
                                  {"fraction", material.fraction},
                                  {"fraction_merged", material.fraction_merged},
                                  {"pieces", material.pieces.size()},
                                  {"largest_piece_voxels", material.pieces.front()}};
          for (const auto &[name, share] :
               {std::make_pair("thickness_p10_m", .1), std::make_pair("thickness_p50_m", .5),
                std::make_pair("thickness_p90_m", .9)})
            if (!material.thickness.empty())
              one[name] = quantile(material.thickness, share);
          json["materials"].push_back(one);
        }
      if (!segmentation.is_periodic)
        json["pieces"] = {{"all", segmentation.loose.n},
                          {"without_support", segmentation.loose.n_loose},
                          {"share_without_support", segmentation.loose.share_loose}};
      if (segmentation.overlap)
        {
          json["labels"] = {{"file", segmentation.overlap->file}, {"overlap", ReportJson::array()}};
          for (const auto &[name, overlap] : segmentation.overlap->of_material)
            json["labels"]["overlap"].push_back({{"name", name},
                                                 {"dice", overlap.dice()},
                                                 {"jaccard", overlap.jaccard()},
                                                 {"voxels_segmentation", overlap.first},
                                                 {"voxels_labels", overlap.second},
                                                 {"voxels_both", overlap.both}});
        }
      return json;
    }
  } // namespace

  std::string
  text_of(const Report &report)
  {
    const auto &statistics = report.statistics;
    std::string text = report.file + ": " + along_xyz([&](const int d) { return std::to_string(report.size[d]); }) +
                       " voxels of " + along_xyz([&](const int d) { return brief(1e6 * report.voxel_size[d]); }) +
                       " um, together " +
                       along_xyz([&](const int d) { return brief(1e6 * report.size[d] * report.voxel_size[d]); }) +
                       " um; " + join(report.remarks, "; ") + "\n  " + report.type + ", values " +
                       brief(statistics.lowest) + " to " + brief(statistics.highest) + ", mean " +
                       brief(statistics.mean) + ", standard deviation " + brief(statistics.deviation) +
                       "\n  percentiles:";
    for (const auto &[share, value] : statistics.percentiles)
      text += (share == statistics.percentiles.front().first ? " " : ", ") + brief(share) + " %: " + brief(value);
    text += "\n";
    for (const auto &suggestion : statistics.suggestions)
      text += "  threshold '" + suggestion.name + "': " + brief(suggestion.threshold) + ", " +
              per_cent(suggestion.share) + " of the voxels from there on\n";
    if (report.segmentation)
      text += "segmented by " + report.scene + ":\n" + text_of(*report.segmentation);
    if (!report.written.empty())
      {
        text += "wrote " + report.written + ", labels 0: empty";
        for (std::size_t i = 0; i < report.segmentation->names.size(); ++i)
          text += ", " + std::to_string(i + 1) + ": " + report.segmentation->names[i];
        text += "\n";
      }
    text.pop_back();
    return text;
  }

  std::string
  json_of(const Report &report)
  {
    const auto &statistics = report.statistics;
    ReportJson  json       = {{"file", report.file},
                              {"type", report.type},
                              {"voxels", report.size},
                              {"voxel_m", report.voxel_size},
                              {"remarks", report.remarks},
                              {"lowest", statistics.lowest},
                              {"highest", statistics.highest},
                              {"mean", statistics.mean},
                              {"standard_deviation", statistics.deviation},
                              {"percentiles", ReportJson::array()},
                              {"suggested_thresholds", ReportJson::object()}};
    for (const auto &[share, value] : statistics.percentiles)
      json["percentiles"].push_back({share, value});
    for (const auto &suggestion : statistics.suggestions)
      json["suggested_thresholds"][suggestion.name] = {{"threshold", suggestion.threshold},
                                                       {"share_from_there_on", suggestion.share}};
    if (report.segmentation)
      {
        json["segmentation"]          = json_of(*report.segmentation);
        json["segmentation"]["scene"] = report.scene;
        json["segmentation"]["file"]  = report.written;
        for (std::size_t i = 0; i < report.segmentation->names.size(); ++i)
          json["segmentation"]["labels_of_file"][std::to_string(i + 1)] = report.segmentation->names[i];
      }
    return json.dump(2, ' ', false, ReportJson::error_handler_t::replace) + "\n";
  }

  std::string
  histogram_table(const Image::Histogram &histogram)
  {
    constexpr std::size_t most  = 512;
    const std::size_t     n     = histogram.count.size();
    const std::size_t     joint = (n + most - 1) / most;
    std::string           text  = "from,below,voxels\n";
    for (std::size_t bin = 0; bin < n; bin += joint)
      {
        const std::size_t past = std::min(bin + joint, n);
        text += Output::to_text(histogram.edge(bin)) + "," + Output::to_text(histogram.edge(past)) + "," +
                std::to_string(
                  std::accumulate(histogram.count.begin() + bin, histogram.count.begin() + past, std::size_t(0))) +
                "\n";
      }
    return text;
  }

  std::string
  pieces_table(const Segmentation &segmentation)
  {
    const auto  &edges  = segmentation.labels.voxel_size;
    const double volume = edges[0] * edges[1] * edges[2];
    std::string  text   = "material,piece,voxels,volume_m3\n";
    for (const auto &material : segmentation.materials)
      for (std::size_t piece = 0; piece < material.pieces.size(); ++piece)
        text += Output::csv_cell(material.name) + "," + std::to_string(piece + 1) + "," +
                std::to_string(material.pieces[piece]) + "," + Output::to_text(volume * material.pieces[piece]) + "\n";
    return text;
  }
} // namespace Stroma::Scans
