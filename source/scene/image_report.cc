#include <stroma/base/text.h>
#include <stroma/scene/image_report.h>
#include <stroma/shapes/faceted.h>

#include <boost/crc.hpp>

#include <cstdio>
#include <filesystem>
#include <numeric>

namespace Stroma
{
  namespace
  {
    /// Numbers along the axes of the scene, as "8 x 8 x 4".
    template <typename Number>
    std::string
    along_axes(const int dim, const Number &number)
    {
      std::vector<std::string> words;
      for (int d = 0; d < dim; ++d)
        words.push_back(number(d));
      return join(words, " x ");
    }

    std::string
    micrometres(const double length)
    {
      return brief(length * 1e6);
    }

    /// Share of each material by index, and at VoxelMaterials::empty of no material.
    std::vector<double>
    fractions_of(const std::vector<double> &n)
    {
      const double        total = std::accumulate(n.begin(), n.end(), 0.);
      std::vector<double> fractions(n);
      for (double &fraction : fractions)
        fraction /= total;
      return fractions;
    }

    std::string
    shares(const std::vector<double> &fractions, const std::vector<std::string> &names)
    {
      std::vector<std::string> words;
      const auto               add = [&](const std::string &name, const double fraction) {
        char text[32];
        std::snprintf(text, sizeof(text), " %.4g %%", 100 * fraction);
        if (fraction > 0)
          words.push_back(name + text);
      };
      for (unsigned int m = 0; m < names.size(); ++m)
        add(names[m], fractions[m]);
      add("empty", fractions[VoxelMaterials::empty]);
      return join(words, ", ");
    }

    /// Adds body @p name's image to the report.
    void
    add_image(const int dim, const std::string &name, const VoxelMaterials &voxels,
              const std::vector<std::string> &names, ImageReport &report)
    {
      std::vector<double> n(voxels.n_before_merging.size(), 0.);
      for (const auto material : voxels.material)
        ++n[material];
      const auto after = fractions_of(n), before = fractions_of(voxels.n_before_merging);
      const auto extent = [&](const int d) { return voxels.size[d] * voxels.voxel_size[d]; };
      report.lines.push_back("image of " + name + " (" + std::filesystem::path(voxels.file).filename().string() +
                             "): " + along_axes(dim, [&](const int d) { return std::to_string(voxels.size[d]); }) +
                             " voxels of " +
                             along_axes(dim, [&](const int d) { return micrometres(voxels.voxel_size[d]); }) +
                             " um, together " + along_axes(dim, [&](const int d) { return micrometres(extent(d)); }) +
                             " um" + (voxels.remarks.empty() ? "" : "; " + voxels.remarks));
      report.lines.push_back("  volume: " + shares(after, names));
      const bool is_merged = voxels.merged != std::array<unsigned int, 3>{{1, 1, 1}};
      if (is_merged)
        report.lines.push_back("  before " + std::to_string(voxels.merged[0]) + " x " +
                               std::to_string(voxels.merged[1]) + " x " + std::to_string(voxels.merged[2]) +
                               " voxels were merged into one: " + shares(before, names));
      const std::string key = "image_" + name + "_";
      for (int d = 0; d < dim; ++d)
        {
          const std::string axis                        = {"xyz"[d]};
          report.results[key + "voxels_" + axis]        = voxels.size[d];
          report.results[key + "voxel_" + axis + "_m"]  = voxels.voxel_size[d];
          report.results[key + "extent_" + axis + "_m"] = extent(d);
        }
      const auto add_fraction = [&](const std::string &material, const unsigned int m) {
        if (voxels.n_before_merging[m] == 0)
          return;
        report.results[key + "fraction_" + material] = after[m];
        if (is_merged)
          report.results[key + "fraction_" + material + "_before_merging"] = before[m];
      };
      for (unsigned int m = 0; m < names.size(); ++m)
        add_fraction(names[m], m);
      add_fraction("empty", VoxelMaterials::empty);
    }
  } // namespace

  template <int dim>
  ImageReport
  report_images(const Scene<dim> &scene)
  {
    ImageReport report;
    for (const auto &body : scene.bodies)
      if (body.is_image())
        add_image(dim, body.name, body.voxels, scene.material_names, report);
    return report;
  }

  template <int dim>
  std::map<std::string, std::string>
  file_checksums(const Scene<dim> &scene)
  {
    std::map<std::string, std::string> checksums;
    const auto                         in_hex = [](const std::uint32_t checksum) {
      char text[32];
      std::snprintf(text, sizeof(text), " (checksum %08x)", checksum);
      return std::string(text);
    };
    for (const auto &body : scene.bodies)
      if (body.is_image())
        checksums["Bodies/" + body.name + "/voxels"] = along_axes(3,
                                                                  [&](const int d) {
                                                                    return std::to_string(body.voxels.size[d]);
                                                                  }) +
                                                       in_hex(body.voxels.checksum);
      else if (body.is_surface())
        {
          const auto        &surface  = dynamic_cast<const Shapes::Faceted<dim> &>(*body.shape);
          const auto        &vertices = surface.vertices;
          boost::crc_32_type crc;
          for (const auto &vertex : vertices)
            crc.process_bytes(vertex.begin_raw(), dim * sizeof(double));
          for (const auto &facet : surface.corners)
            crc.process_bytes(facet.data(), sizeof(facet));
          checksums["Bodies/" + body.name + "/surface"] = std::to_string(vertices.size()) + " corners" +
                                                          in_hex(crc.checksum());
        }
    return checksums;
  }

  template ImageReport                        report_images(const Scene<2> &);
  template ImageReport                        report_images(const Scene<3> &);
  template std::map<std::string, std::string> file_checksums(const Scene<2> &);
  template std::map<std::string, std::string> file_checksums(const Scene<3> &);
} // namespace Stroma
