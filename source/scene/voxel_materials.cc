#include "at_entry.h"
#include "label_map.h"

#include <stroma/base/node_copy.h>
#include <stroma/base/on_root.h>
#include <stroma/base/text.h>
#include <stroma/image/merge.h>
#include <stroma/scene/image_materials.h>
#include <stroma/scene/voxel_materials.h>

#include <boost/crc.hpp>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    /// Merge the image's voxels and keep what is said of them. Returns the materials. Of materials that are equally frequent
    /// in a block that with the lowest label is taken.
    std::vector<std::uint8_t>
    merge(const ImageSettings &settings, const std::vector<std::string> &names, ImageMaterials &image,
          VoxelMaterials &voxels)
    {
      std::copy(settings.merge.begin(), settings.merge.end(), voxels.merged.begin());
      if (voxels.merged != std::array<unsigned int, 3>{{1, 1, 1}})
        {
          const auto                    rank = LabelMap(settings.where_materials, settings.materials, names).ranks();
          std::array<std::uint8_t, 256> material{};
          for (unsigned int m = 0; m < rank.size(); ++m)
            material[rank[m]] = m;
          for (auto &voxel : image.material.data)
            voxel = rank[voxel];
          auto merged = at_entry(settings.where_merge,
                                 [&] { return Image::merge_labels(image.material, voxels.merged); });
          if (merged.n_ties > 0)
            image.remarks.push_back("of " + grouped(merged.data.size()) + " merged voxels " + grouped(merged.n_ties) +
                                    " were ties, given to the lowest label");
          for (auto &voxel : merged.data)
            voxel = material[voxel];
          image.material = std::move(merged);
        }
      std::vector<bool> occurs(VoxelMaterials::empty + 1, false);
      for (const auto voxel : image.material.data)
        occurs[voxel] = true;
      for (unsigned int m = 0; m < names.size(); ++m)
        if (image.n[m] > 0 && !occurs[m])
          throw UserError(settings.where_merge, "merging leaves no voxel of material '" + names[m] + "', which had " +
                                                  grouped(static_cast<unsigned long long>(image.n[m])) +
                                                  "; merge fewer voxels");
      return std::move(image.material.data);
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
      auto image              = image_materials(settings, names);
      auto materials          = merge(settings, names, image, voxels);
      voxels.size             = image.material.size;
      voxels.voxel_size       = image.material.voxel_size;
      voxels.remarks          = join(image.remarks, "; ");
      voxels.n_before_merging = image.n;
      voxels.corner           = settings.corner;
      voxels.frame            = image.frame;
      for (unsigned int d = 0; d < 3; ++d) // cropped and merged
        voxels.frame.first[d] += (image.material.origin[d] + .5 * voxels.voxel_size[d] * (1. - 1. / voxels.merged[d])) /
                                 voxels.frame.unit;
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
      voxels.frame.unit       = broadcast(comm, voxels.frame.unit, 0);
      voxels.frame.first      = broadcast(comm, voxels.frame.first, 0);
      voxels.frame.space      = broadcast(comm, voxels.frame.space, 0);
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
