#pragma once

#include <stroma/scene/scene.h>

#include <map>
#include <string>
#include <vector>

namespace Stroma
{
  /// What was understood of the images of a scene, so that a person sees a mistake.
  struct ImageReport
  {
    /// For people: size, voxel, extent, where the unit is from, share of each material.
    std::vector<std::string> lines;
    /// The same as named numbers with units: "image_BODY_extent_x_m", "image_BODY_fraction_MATERIAL", ...
    std::map<std::string, double> results;
  };

  /// Local; the same on all ranks.
  template <int dim>
  ImageReport report_images(const Scene<dim> &scene);

  /// "Bodies/NAME/voxels", or "/surface" -> size and checksum of what its file holds, for each body from a file: a resumed
  /// run must find the same. The same on all ranks.
  template <int dim>
  std::map<std::string, std::string> file_checksums(const Scene<dim> &scene);
} // namespace Stroma
