#pragma once

#include <stroma/image/overlap.h>
#include <stroma/image/volume.h>
#include <stroma/scans/loose_pieces.h>
#include <stroma/scene/image_settings.h>

#include <optional>
#include <string>
#include <vector>

namespace Stroma::Scans
{
  /// What one material of a segmented image is.
  struct MaterialShare
  {
    std::string              name;
    double                   fraction        = 0; ///< of the image's volume
    double                   fraction_merged = 0; ///< the same as a run sees it
    std::vector<std::size_t> pieces;              ///< voxels of each connected piece, the largest first
    std::vector<double>      thickness;           ///< Image::ridge_thickness [m]
  };

  /// A label image against the segmentation.
  struct LabelOverlap
  {
    std::string                                         file, remark;
    std::vector<std::pair<std::string, Image::Overlap>> of_material;
  };

  /// An image, segmented by a scene.
  struct Segmentation
  {
    std::string                 body;
    std::vector<std::string>    names;      ///< of the scene's materials
    Image::Volume<float>        grey;       ///< cropped
    std::array<double, 3>       corner{};   ///< its lower corner in the scene [m]
    Image::Volume<std::uint8_t> labels;     ///< 0: empty; 1, ...: the scene's materials; not merged; where the scan is
    std::string                 space;      ///< of the scan's coordinates, see Image::Frame
    std::vector<MaterialShare>  materials;  ///< in turn; those that the image holds
    std::vector<std::string>    report;     ///< lines that a run says of its images
    std::vector<double>         thresholds; ///< lower and upper, where grey values were segmented
    LoosePieces                 loose;
    bool                        is_periodic = false; ///< then loose pieces are not counted
    std::optional<LabelOverlap> overlap;
  };

  /// How labels to compare with are read.
  struct LabelRequest
  {
    std::string file;
    std::string materials; ///< as in the entry 'Materials'; empty: as the scene has it
  };

  /// The image of body @p b of @p scene, which @p settings are the entries of, segmented and measured. Throws UserError. Local.
  /// @param image its grey values, not cropped
  template <int dim>
  Segmentation segmentation_of(const Scene<dim> &scene, unsigned int b, const ImageSettings &settings,
                               const LabelRequest &labels, Image::ReadVolume<float> image);
} // namespace Stroma::Scans
