#pragma once

#include <stroma/image/volume.h>

#include <cstdint>

namespace Stroma::Image
{
  /// What a synthetic microvessel image looks like.
  struct PhantomSettings
  {
    /// Number of voxels; size[2] == 1 makes a slice with vessels in its plane.
    std::array<unsigned int, 3> size = {{128, 128, 64}};
    /// Edge lengths of a voxel [m].
    std::array<double, 3> voxel_size = {{1e-6, 1e-6, 1e-6}};
    /// Share of the voxels that are vessel, in (0, 0.5].
    double vessel_fraction = 0.1;
    /// Mean vessel radius over the length (reached to about 10 %) [m], at least half the smallest voxel edge.
    double radius = 3e-6;
    /// Standard deviation of the Gaussian blur of the image [m]; 0 for none.
    double blur = 1e-6;
    /// Standard deviation of the noise in a bright vessel over the difference between vessel and background.
    double noise = 0.1;
    /// The same seed gives the same phantom.
    unsigned int seed = 1;
  };

  /// Memory that make_phantom() takes at most [bytes], measured on 1 to 4 million voxels.
  inline double
  memory_of_phantom(const PhantomSettings &settings)
  {
    constexpr double per_voxel = 17.;
    return per_voxel * settings.size[0] * settings.size[1] * settings.size[2];
  }

  /// A synthetic image and the truth behind it.
  struct Phantom
  {
    /// What the microscope would see, 0 to 255.
    Volume<std::uint8_t> image;
    /// 255 vessel, 0 background.
    Volume<std::uint8_t> labels;
  };

  /// Grey values of background and vessel before blur and noise.
  constexpr double background_value = 40, vessel_value = 180;

  /**
   * Make a synthetic microvessel stack: the tubes of grow_tubes(), blurred by the optics and with shot noise, whose
   * variance is proportional to the brightness (the normal limit of the Poisson distribution).
   * Throws UserError for settings out of range.
   */
  Phantom make_phantom(const PhantomSettings &settings);
} // namespace Stroma::Image
