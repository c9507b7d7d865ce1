#include <stroma/base/text.h>
#include <stroma/image/crop.h>
#include <stroma/image/pieces.h>
#include <stroma/image/thickness.h>
#include <stroma/scans/segmentation.h>
#include <stroma/scene/image_materials.h>
#include <stroma/scene/image_report.h>

#include <algorithm>
#include <filesystem>

namespace Stroma::Scans
{
  namespace
  {
    /// Puts an image, whose corner is at zero but for a crop, where the scan's header has it.
    void
    place(Image::Volume<std::uint8_t> &labels, const Image::Frame &frame)
    {
      for (unsigned int d = 0; d < 3; ++d)
        labels.origin[d] += frame.first[d] * frame.unit - .5 * labels.voxel_size[d];
    }

    /// Labels as materials: by number, 0 for none.
    Image::Volume<std::uint8_t>
    numbered(const Image::Volume<std::uint8_t> &material)
    {
      auto labels = material;
      for (auto &label : labels.data)
        label = label == VoxelMaterials::empty ? 0 : label + 1;
      return labels;
    }

    MaterialShare
    share_of(const Segmentation &segmentation, const VoxelMaterials &voxels, const std::string &name,
             const unsigned int material, const Image::Connectivity connectivity)
    {
      const auto &labels = segmentation.labels;
      auto        mask   = Image::volume_like<std::uint8_t>(labels, 0);
      std::transform(labels.data.begin(), labels.data.end(), mask.data.begin(),
                     [&](const std::uint8_t label) { return label == material + 1; });
      MaterialShare share;
      share.name            = name;
      share.pieces          = Image::find_pieces(mask, connectivity).size;
      share.thickness       = Image::ridge_thickness(mask);
      share.fraction        = double(std::count(mask.data.begin(), mask.data.end(), 1)) / mask.data.size();
      share.fraction_merged = double(std::count(voxels.material.begin(), voxels.material.end(), material)) /
                              voxels.material.size();
      return share;
    }

    /// The label image in the place of the segmentation: of its size, or of that of the image before it is cropped.
    Image::Volume<std::uint16_t>
    read_labels(const std::string &file, const ImageSettings &settings, const Image::Volume<std::uint8_t> &like)
    {
      auto reading       = settings.reading;
      reading.voxel_size = like.voxel_size;
      reading.channel = reading.frame     = 0;
      Image::Volume<std::uint16_t> labels = Image::read(file, reading);
      const auto                   words  = [](const std::array<unsigned int, 3> &size) {
        return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]);
      };
      const auto &first = settings.crop_first, &size = settings.crop_size;
      if (labels.size != like.size && !size.empty())
        labels = Image::crop(labels, {{first[0], first[1], first[2]}}, {{size[0], size[1], size[2]}});
      if (labels.size != like.size)
        throw UserError("--labels " + file, "the label image has " + words(labels.size) + " voxels, the segmentation " +
                                              words(like.size) + "; give labels of the same image");
      return labels;
    }

    /// A mask of 0 and one other value stands beside thresholds as labels 0 and 1. Says so.
    std::string
    take_mask(Image::Volume<std::uint16_t> &labels)
    {
      const unsigned int highest = *std::max_element(labels.data.begin(), labels.data.end());
      if (highest <= 1 || std::any_of(labels.data.begin(), labels.data.end(),
                                      [&](const unsigned int label) { return label != 0 && label != highest; }))
        return "";
      for (auto &label : labels.data)
        label = label != 0;
      return std::to_string(highest) + " taken as label 1";
    }

    LabelOverlap
    overlap_with(const LabelRequest &request, const ImageSettings &settings, const std::vector<std::string> &names,
                 const Segmentation &segmentation)
    {
      LabelOverlap result;
      result.file     = request.file;
      auto       read = read_labels(request.file, settings, segmentation.labels);
      const bool own  = request.materials.empty();
      if (own && settings.threshold)
        result.remark = take_mask(read);
      const auto texts  = own ? settings.materials : split(request.materials, ',');
      const auto labels = numbered(
        materials_of_labels(read, own ? "--labels " + request.file : "--label-materials", texts, names).material);
      const auto found = Image::overlaps(segmentation.labels.data, labels.data);
      for (unsigned int m = 0; m < names.size(); ++m)
        if (found[m + 1].first + found[m + 1].second > 0)
          result.of_material.emplace_back(names[m], found[m + 1]);
      return result;
    }
  } // namespace

  template <int dim>
  Segmentation
  segmentation_of(const Scene<dim> &scene, const unsigned int b, const ImageSettings &settings,
                  const LabelRequest &labels, Image::ReadVolume<float> image)
  {
    const auto  &voxels = scene.bodies[b].voxels;
    Segmentation result;
    crop_grey(settings, image);
    const auto materials = image_materials(settings, scene.material_names, image);
    result.body          = scene.bodies[b].name;
    result.names         = scene.material_names;
    result.grey          = std::move(image);
    result.corner        = settings.corner;
    result.labels        = numbered(materials.material);
    result.space         = materials.frame.space;
    place(result.labels, materials.frame);
    result.thresholds = materials.thresholds;
    result.report     = report_images(scene).lines;
    for (unsigned int m = 0; m < scene.material_names.size(); ++m)
      if (materials.n[m] > 0)
        result.materials.push_back(share_of(result, voxels, scene.material_names[m], m, settings.segment.connectivity));
    result.is_periodic = std::any_of(scene.periodic.begin(), scene.periodic.end(), [](const bool p) { return p; });
    if (!result.is_periodic)
      result.loose = loose_pieces(scene, b);
    if (!labels.file.empty())
      result.overlap = overlap_with(labels, settings, scene.material_names, result);
    return result;
  }

  template Segmentation segmentation_of(const Scene<2> &, unsigned int, const ImageSettings &, const LabelRequest &,
                                        Image::ReadVolume<float>);
  template Segmentation segmentation_of(const Scene<3> &, unsigned int, const ImageSettings &, const LabelRequest &,
                                        Image::ReadVolume<float>);
} // namespace Stroma::Scans
