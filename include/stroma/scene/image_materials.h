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

  /// Crops grey values as @p settings say. Throws UserError. Local.
  void crop_grey(const ImageSettings &settings, Image::Volume<float> &grey);

  /**
   * Reads, crops and segments the image that @p settings name. Throws UserError for an image that is not as the settings
   * say, a label without a material and a material without a voxel. Local.
   * @param names of the scene's materials
   */
  ImageMaterials image_materials(const ImageSettings &settings, const std::vector<std::string> &names);

  /// The same where @p grey, the image's cropped grey values, is at hand. Labels are read from the file all the same.
  ImageMaterials image_materials(const ImageSettings &settings, const std::vector<std::string> &names,
                                 const Image::ReadVolume<float> &grey);

  /// Materials of a volume of labels by @p texts as in the entry 'Materials'. Throws UserError beginning with @p where for a
  /// label that has none.
  ImageMaterials materials_of_labels(const Image::Volume<std::uint16_t> &labels, const std::string &where,
                                     const std::vector<std::string> &texts, const std::vector<std::string> &names);
} // namespace Stroma
