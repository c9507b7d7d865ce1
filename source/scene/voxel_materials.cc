#include "image_settings.h"
#include "label_map.h"

#include <stroma/base/memory.h>
#include <stroma/base/node_copy.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/image/crop.h>
#include <stroma/image/merge.h>
#include <stroma/scene/voxel_materials.h>

#include <boost/crc.hpp>

#include <algorithm>
#include <filesystem>

namespace Stroma
{
  namespace
  {
    using Labels = Image::Volume<std::uint16_t>;

    std::array<unsigned int, 3>
    triple(const std::vector<unsigned int> &v)
    {
      return {{v[0], v[1], v[2]}};
    }

    /// Runs @p work; puts the place of the entry before the message of a UserError.
    template <typename Work>
    auto
    at(const std::string &where, const Work &work)
    {
      try
        {
          return work();
        }
      catch (const UserError &error)
        {
          throw UserError(where, error.what());
        }
      catch (const std::filesystem::filesystem_error &error)
        {
          throw UserError(where, shown(error.path1().string()) + ": " + error.code().message());
        }
    }

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

    /// The cropped image, its values as type T: labels or grey values.
    template <typename T>
    Image::Volume<T>
    load(const ImageSettings &settings, VoxelMaterials &voxels)
    {
      auto volume    = at(settings.where_file, [&] {
        return settings.file == "phantom" ? phantom_of<T>(settings) : Image::read<T>(settings.file, settings.reading);
      });
      voxels.remarks = join(volume.remarks, "; ");
      if (settings.crop_size.empty())
        return std::move(static_cast<Image::Volume<T> &>(volume));
      return at(settings.where_crop,
                [&] { return Image::crop<T>(volume, triple(settings.crop_first), triple(settings.crop_size)); });
    }

    /// Labels, and for messages the range of what the image held.
    Labels
    labelled(const ImageSettings &settings, VoxelMaterials &voxels, std::string &range)
    {
      const auto range_of = [](const auto &data) {
        const auto [lowest, highest] = std::minmax_element(data.begin(), data.end());
        return brief(*lowest) + " to " + brief(*highest);
      };
      if (!settings.threshold)
        {
          Labels labels = load<std::uint16_t>(settings, voxels);
          range         = range_of(labels.data);
          return labels;
        }
      const auto grey      = load<float>(settings, voxels);
      range                = range_of(grey.data);
      const auto segmented = at(settings.where_threshold, [&] {
        return Image::hysteresis_threshold(grey, settings.lower_threshold, settings.upper_threshold,
                                           settings.connectivity);
      });
      return {segmented.size, segmented.voxel_size, segmented.origin, {segmented.data.begin(), segmented.data.end()}};
    }

    [[noreturn]] void
    refuse_without_voxels(const ImageSettings &settings, const LabelMap &map, const std::string &name,
                          const unsigned int material, const std::string &range)
    {
      const std::string none = "material '" + name + "' would hold no voxel: ";
      if (!settings.threshold)
        throw UserError(settings.where_materials, none + "no label of " + map.texts_of(material) +
                                                    " occurs, the image's labels are in " + range +
                                                    "; change 'Materials'");
      if (map.at(0) != static_cast<int>(material) && map.at(1) != static_cast<int>(material))
        throw UserError(settings.where_materials, none + "a threshold gives labels 0 and 1 only, 'Materials' has " +
                                                    map.texts_of(material) + "; change 'Materials'");
      throw UserError(settings.where_threshold, none + "the thresholds leave no voxel with label " +
                                                  (map.at(0) == static_cast<int>(material) ? "0" : "1") +
                                                  ", the image's values are " + range + "; change the thresholds");
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

    /// Check that each label has a material and each material a voxel; count the materials' voxels.
    void
    check_labels(const ImageSettings &settings, const LabelMap &map, const std::vector<std::string> &names,
                 const Labels &labels, const std::string &range, VoxelMaterials &voxels)
    {
      const auto count = count_labels(labels);
      voxels.n_before_merging.assign(VoxelMaterials::empty + 1, 0.);
      for (unsigned int label = 0; label < count.size(); ++label)
        if (count[label] > 0 && map.at(label) < 0)
          throw UserError(settings.where_materials,
                          "the image has " + grouped(count[label]) + " voxels of label " + std::to_string(label) +
                            ", which 'Materials' does not name; add '" + std::to_string(label) + ": material' or '" +
                            std::to_string(label) + ": empty'" +
                            (settings.threshold ? "" : ", or set 'Interpretation = threshold' for grey values"));
        else if (count[label] > 0)
          voxels.n_before_merging[map.at(label)] += count[label];
      for (const unsigned int material : map.named())
        if (voxels.n_before_merging[material] == 0)
          refuse_without_voxels(settings, map, names[material], material, range);
      if (map.named().empty())
        throw UserError(settings.where_materials, "'Materials' has no material, so the body would be empty; name one");
      if (const auto absent = map.absent(count); !absent.empty())
        {
          std::vector<std::string> words;
          for (std::size_t i = 0; i < std::min<std::size_t>(absent.size(), 5); ++i)
            words.push_back(std::to_string(absent[i]));
          voxels.remarks += (voxels.remarks.empty() ? "" : "; ") + std::string("no voxel has label ") +
                            join(words, ", ") + (absent.size() > 5 ? ", ..." : "") + " of 'Materials'";
        }
    }

    /// Materials of the voxels, merged. Labels of one material count as one.
    std::vector<std::uint8_t>
    merge(const ImageSettings &settings, const LabelMap &map, const std::vector<std::string> &names, Labels &labels,
          VoxelMaterials &voxels)
    {
      std::vector<int>           first(VoxelMaterials::empty + 1, -1); // lowest label of each material
      std::vector<std::uint16_t> same(LabelMap::n_labels, 0);
      for (unsigned int label = 0; label < LabelMap::n_labels; ++label)
        if (const int material = map.at(label); material >= 0)
          {
            if (first[material] < 0)
              first[material] = label;
            same[label] = first[material];
          }
      for (auto &label : labels.data)
        label = same[label];
      voxels.merged = triple(settings.merge);
      if (voxels.merged != std::array<unsigned int, 3>{{1, 1, 1}})
        labels = at(settings.where_merge, [&] { return Image::merge_labels(labels, voxels.merged); });
      voxels.size       = labels.size;
      voxels.voxel_size = labels.voxel_size;
      std::vector<std::uint8_t> materials(labels.data.size());
      std::vector<bool>         occurs(VoxelMaterials::empty + 1, false);
      for (std::size_t i = 0; i < labels.data.size(); ++i)
        {
          materials[i]         = static_cast<std::uint8_t>(map.at(labels.data[i]));
          occurs[materials[i]] = true;
        }
      for (const unsigned int material : map.named())
        if (!occurs[material])
          throw UserError(settings.where_merge,
                          "merging leaves no voxel of material '" + names[material] + "', which had " +
                            grouped(static_cast<unsigned long long>(voxels.n_before_merging[material])) +
                            "; merge fewer voxels");
      return materials;
    }

    std::uint32_t
    checksum_of(const VoxelMaterials &voxels, const std::vector<std::uint8_t> &materials)
    {
      boost::crc_32_type crc;
      crc.process_bytes(voxels.size.data(), sizeof(voxels.size));
      crc.process_bytes(voxels.voxel_size.data(), sizeof(voxels.voxel_size));
      crc.process_bytes(voxels.corner.data(), sizeof(voxels.corner));
      crc.process_bytes(materials.data(), materials.size());
      return crc.checksum();
    }

    /// Returns the materials of the voxels.
    std::vector<std::uint8_t>
    read(const ImageSettings &settings, const std::vector<std::string> &names, VoxelMaterials &voxels)
    {
      const LabelMap map(settings.where_materials, settings.materials, names);
      std::string    range;
      Labels         labels = labelled(settings, voxels, range);
      check_labels(settings, map, names, labels, range, voxels);
      auto materials  = merge(settings, map, names, labels, voxels);
      voxels.corner   = settings.corner;
      voxels.checksum = checksum_of(voxels, materials);
      return materials;
    }

    void
    broadcast(VoxelMaterials &voxels, const MPI_Comm comm)
    {
      using dealii::Utilities::MPI::broadcast;
      voxels.size             = broadcast(comm, voxels.size, 0);
      voxels.voxel_size       = broadcast(comm, voxels.voxel_size, 0);
      voxels.corner           = broadcast(comm, voxels.corner, 0);
      voxels.remarks          = broadcast(comm, voxels.remarks, 0);
      voxels.merged           = broadcast(comm, voxels.merged, 0);
      voxels.n_before_merging = broadcast(comm, voxels.n_before_merging, 0);
      voxels.checksum         = broadcast(comm, voxels.checksum, 0);
    }
  } // namespace

  void
  VoxelMaterials::find_specimen()
  {
    first = size;
    past  = {{0, 0, 0}};
    std::array<unsigned int, 3> i;
    for (i[2] = 0; i[2] < size[2]; ++i[2])
      for (i[1] = 0; i[1] < size[1]; ++i[1])
        for (i[0] = 0; i[0] < size[0]; ++i[0])
          if (at(i[0], i[1], i[2]) != empty)
            for (unsigned int d = 0; d < 3; ++d)
              {
                first[d] = std::min(first[d], i[d]);
                past[d]  = std::max(past[d], i[d] + 1);
              }
    if (past[0] == 0)
      {
        first = {{0, 0, 0}};
        past  = size;
      }
  }

  void
  VoxelMaterials::add(Parameters &p, const std::vector<std::string> &materials, const unsigned int dim,
                      const MPI_Comm comm)
  {
    ImageSettings settings;
    settings.add(p);
    settings.reading.plane = dim == 2;
    file                   = settings.file;
    if (p.get_mode() == Parameters::Mode::document)
      {
        size = past = {{1, 1, 1}};
        return;
      }
    std::vector<std::uint8_t> of_voxels; // on the root
    on_root(comm, [&] { of_voxels = read(settings, materials, *this); });
    broadcast(*this, comm);
    memory   = one_copy_a_node(std::move(of_voxels), comm);
    material = {memory.get(), std::size_t(size[0]) * size[1] * size[2]};
    find_specimen();
    if (dim == 2 && size[2] != 1)
      throw UserError(settings.where_file, "a 2D scene needs one slice, but the image has " + std::to_string(size[2]) +
                                             "; choose one with 'Crop first' and 'Crop size' (size 1 in z)");
  }
} // namespace Stroma
