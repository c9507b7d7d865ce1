#pragma once

#include <stroma/scene/image_settings.h>

#include <cstdint>

namespace Stroma
{
  /// The voxels of a body's image as materials, before voxels are merged.
  struct ImageMaterials
  {
    Image::Volume<std::uint8_t> material;   ///< index of the scene's materials, or VoxelMaterials::empty
    std::vector<double>         n;          ///< voxels of each material by index, and at VoxelMaterials::empty of none
    Image::Frame                frame;      ///< of the file, without crop
    std::vector<double>         thresholds; ///< lower and upper, of grey values
    std::vector<std::string>    remarks;    ///< how the image was understood and segmented, for people
  };

  /// The grey values of the image that @p settings name, cropped. Throws UserError. Local.
  Image::ReadVolume<float> grey_values(const ImageSettings &settings);

  /**
   * Reads, crops and segments the image that @p settings name. Throws UserError for an image that is not as the settings
   * say, a label without a material and a material without a voxel. Local.
   * @param names of the scene's materials
   */
  ImageMaterials image_materials(const ImageSettings &settings, const std::vector<std::string> &names);

  /// Materials of a volume of labels by @p texts as in the entry 'Materials'. Throws UserError beginning with @p where for a
  /// label that has none.
  ImageMaterials materials_of_labels(const Image::Volume<std::uint16_t> &labels, const std::string &where,
                                     const std::vector<std::string> &texts, const std::vector<std::string> &names);
} // namespace Stroma
