#include "at_entry.h"
#include "label_map.h"

#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/image/crop.h>
#include <stroma/scene/image_materials.h>
#include <stroma/scene/voxel_materials.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    using Labels = Image::Volume<std::uint16_t>;

    template <typename T>
    Image::ReadVolume<T>
    phantom_of(const ImageSettings &settings)
    {
      Memory::require_here(Image::memory_of_phantom(settings.phantom), "", "this phantom");
      const auto           phantom = Image::make_phantom(settings.phantom);
      const auto          &source  = settings.threshold ? phantom.image : phantom.labels;
      Image::ReadVolume<T> volume;
      volume.size       = source.size;
      volume.voxel_size = source.voxel_size;
      volume.data.assign(source.data.begin(), source.data.end());
      return volume;
    }

    template <typename T>
    void
    crop(const ImageSettings &settings, Image::Volume<T> &volume)
    {
      const auto &first = settings.crop_first, &size = settings.crop_size;
      if (!size.empty())
        volume = at_entry(settings.where_crop, [&] {
          return Image::crop<T>(volume, {{first[0], first[1], first[2]}}, {{size[0], size[1], size[2]}});
        });
    }

    /// The cropped image, its values as type T: labels or grey values.
    template <typename T>
    Image::ReadVolume<T>
    load(const ImageSettings &settings)
    {
      auto volume = at_entry(settings.where_file, [&] {
        return settings.file == "phantom" ? phantom_of<T>(settings) : Image::read<T>(settings.file, settings.reading);
      });
      crop<T>(settings, volume);
      return volume;
    }

    std::string
    range_of(const double lowest, const double highest)
    {
      return brief(lowest) + " to " + brief(highest);
    }

    /// Number of voxels of each label.
    std::vector<std::size_t>
    count_labels(const Labels &labels)
    {
      std::vector<std::size_t> count(LabelMap::n_labels, 0);
      for (const auto label : labels.data)
        ++count[label];
      return count;
    }

    /// Materials of labels, each of which must have one.
    ImageMaterials
    by_map(const Labels &labels, const LabelMap &map, const std::string &where, const std::string &advice)
    {
      const auto     count = count_labels(labels);
      ImageMaterials result;
      result.n.assign(VoxelMaterials::empty + 1, 0.);
      for (unsigned int label = 0; label < count.size(); ++label)
        if (count[label] > 0 && map.at(label) < 0)
          throw UserError(where, "the image has " + counted(count[label], "voxel") + " of label " +
                                   std::to_string(label) + ", which 'Materials' does not name; add '" +
                                   std::to_string(label) + ": material' or '" + std::to_string(label) + ": empty'" +
                                   advice);
        else if (count[label] > 0)
          result.n[map.at(label)] += count[label];
      result.material = Image::volume_like<std::uint8_t>(labels, 0);
      std::transform(labels.data.begin(), labels.data.end(), result.material.data.begin(),
                     [&](const std::uint16_t label) { return static_cast<std::uint8_t>(map.at(label)); });
      const auto absent = map.absent(count);
      if (absent.empty())
        return result;
      std::vector<std::string> words;
      for (std::size_t i = 0; i < std::min<std::size_t>(absent.size(), 5); ++i)
        words.push_back(std::to_string(absent[i]));
      result.remarks.push_back("no voxel has label " + join(words, ", ") + (absent.size() > 5 ? ", ..." : "") +
                               " of 'Materials'");
      return result;
    }

    std::string
    none_of(const std::string &name)
    {
      return "material '" + name + "' would hold no voxel: ";
    }

    /// Throws for a material without a voxel in an image of labels.
    void
    check_labels(const ImageSettings &settings, const LabelMap &map, const std::vector<std::string> &names,
                 const Labels &labels, const ImageMaterials &result)
    {
      for (const unsigned int material : map.named())
        if (result.n[material] == 0)
          {
            const auto ends = std::minmax_element(labels.data.begin(), labels.data.end());
            throw UserError(settings.where_materials, none_of(names[material]) + "no label of " +
                                                        map.texts_of(material) + " occurs, the image's labels are in " +
                                                        range_of(*ends.first, *ends.second) + "; change 'Materials'");
          }
    }

    /// The same for a segmented one.
    void
    check_segmented(const ImageSettings &settings, const LabelMap &map, const std::vector<std::string> &names,
                    const Image::Segmented &segmented, const ImageMaterials &result)
    {
      for (const unsigned int material : map.named())
        {
          if (result.n[material] > 0)
            continue;
          const bool is_0 = map.at(0) == static_cast<int>(material), is_1 = map.at(1) == static_cast<int>(material);
          if (!is_0 && !is_1)
            throw UserError(settings.where_materials, none_of(names[material]) +
                                                        "a threshold gives labels 0 and 1 only, 'Materials' has " +
                                                        map.texts_of(material) + "; change 'Materials'");
          if (is_1 && segmented.n_largest > 0)
            throw UserError(settings.where_pieces,
                            none_of(names[material]) + "the largest piece of the structure has " +
                              counted(segmented.n_largest, "voxel") + "; lower 'Smallest piece'");
          throw UserError(settings.where_threshold,
                          none_of(names[material]) + "the thresholds leave no voxel with label " + (is_0 ? "0" : "1") +
                            ", the image's values are " + range_of(segmented.lowest, segmented.highest) +
                            (settings.segment.smoothing == Image::Smoothing::none ? "" : " once smoothed") +
                            "; change the thresholds");
        }
    }

    ImageMaterials
    segmented_materials(const ImageSettings &settings, const LabelMap &map, const std::vector<std::string> &names,
                        const Image::ReadVolume<float> &grey)
    {
      const auto segmented = at_entry(settings.where_threshold, [&] { return Image::segment(grey, settings.segment); });
      const auto  &mask    = segmented.mask;
      const Labels labels  = {mask.size, mask.voxel_size, mask.origin, {mask.data.begin(), mask.data.end()}};
      auto         result  = by_map(labels, map, settings.where_materials, "");
      result.thresholds    = {segmented.lower, segmented.upper};
      result.frame         = grey.frame;
      result.remarks.insert(result.remarks.begin(), segmented.remarks.begin(), segmented.remarks.end());
      result.remarks.insert(result.remarks.begin(), grey.remarks.begin(), grey.remarks.end());
      check_segmented(settings, map, names, segmented, result);
      return result;
    }

    ImageMaterials
    labelled_materials(const ImageSettings &settings, const LabelMap &map, const std::vector<std::string> &names)
    {
      const auto labels = load<std::uint16_t>(settings);
      auto       result = by_map(labels, map, settings.where_materials,
                                 ", or set 'Interpretation = threshold' for grey values");
      result.frame      = labels.frame;
      result.remarks.insert(result.remarks.begin(), labels.remarks.begin(), labels.remarks.end());
      check_labels(settings, map, names, labels, result);
      return result;
    }
  } // namespace

  void
  crop_grey(const ImageSettings &settings, Image::Volume<float> &grey)
  {
    crop(settings, grey);
  }

  ImageMaterials
  image_materials(const ImageSettings &settings, const std::vector<std::string> &names)
  {
    return settings.threshold ? image_materials(settings, names, load<float>(settings)) :
                                image_materials(settings, names, {});
  }

  ImageMaterials
  image_materials(const ImageSettings &settings, const std::vector<std::string> &names,
                  const Image::ReadVolume<float> &grey)
  {
    const LabelMap map(settings.where_materials, settings.materials, names);
    auto           result = settings.threshold ? segmented_materials(settings, map, names, grey) :
                                                 labelled_materials(settings, map, names);
    if (map.named().empty())
      throw UserError(settings.where_materials, "'Materials' has no material, so the body would be empty; name one");
    return result;
  }

  ImageMaterials
  materials_of_labels(const Image::Volume<std::uint16_t> &labels, const std::string &where,
                      const std::vector<std::string> &texts, const std::vector<std::string> &names)
  {
    return by_map(labels, LabelMap(where, texts, names), where,
                  " there or in --label-materials, if this is an image of labels");
  }
} // namespace Stroma
