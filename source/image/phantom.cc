#include <stroma/image/phantom.h>

#include "words.h"

#include <stroma/base/errors.h>
#include <stroma/image/random.h>
#include <stroma/image/smooth.h>
#include <stroma/image/tubes.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace Stroma::Image
{
  namespace
  {
    void
    check(const bool allowed, const std::string &what, const double given, const std::string &range)
    {
      if (!allowed)
        throw UserError("Phantom", what + " " + number(given) + " is not allowed; it must be " + range);
    }

    void
    check_settings(const PhantomSettings &settings)
    {
      for (unsigned int d = 0; d < 3; ++d)
        {
          check(settings.size[d] > 0, "size", settings.size[d], "at least 1");
          check(settings.voxel_size[d] > 0 && std::isfinite(settings.voxel_size[d]), "voxel size",
                settings.voxel_size[d], "positive");
        }
      const double smallest = *std::min_element(settings.voxel_size.begin(), settings.voxel_size.end());
      check(settings.vessel_fraction > 0 && settings.vessel_fraction <= 0.5, "vessel fraction",
            settings.vessel_fraction, "in (0, 0.5]");
      check(settings.radius >= smallest / 2 && std::isfinite(settings.radius), "radius in voxels",
            settings.radius / smallest, "at least 0.5");
      check(settings.blur >= 0 && settings.blur <= 20 * smallest, "blur in voxels", settings.blur / smallest,
            "0 to 20");
      check(settings.noise >= 0 && settings.noise <= 10, "noise", settings.noise, "0 to 10");
    }

    /// The labels as brightness 0 to 1, blurred.
    Volume<float>
    blurred(const Volume<std::uint8_t> &labels, const double blur)
    {
      Volume<float> brightness = volume_like<float>(labels, 0);
      std::transform(labels.data.begin(), labels.data.end(), brightness.data.begin(),
                     [](const std::uint8_t label) { return label / 255.f; });
      if (blur == 0)
        return brightness;
      return gaussian(brightness, blur, .005); // so that the same seed gives the phantom of earlier versions
    }

    /// Grey values with shot noise: the variance is that of a bright vessel times value / vessel_value.
    Volume<std::uint8_t>
    photographed(const Volume<float> &brightness, const double noise, Random &random)
    {
      constexpr double     contrast  = vessel_value - background_value;
      const double         deviation = noise * contrast / std::sqrt(vessel_value);
      Volume<std::uint8_t> image     = volume_like<std::uint8_t>(brightness, 0);
      for (std::size_t i = 0; i < image.data.size(); ++i)
        {
          const double mean  = background_value + contrast * brightness.data[i];
          const double value = mean + deviation * std::sqrt(mean) * random.normal();
          image.data[i]      = std::uint8_t(std::lround(std::clamp(value, 0., 255.)));
        }
      return image;
    }
  } // namespace

  Phantom
  make_phantom(const PhantomSettings &settings)
  {
    check_settings(settings);
    Random     random(settings.seed);
    const auto labels = grow_tubes(settings, random);
    return {photographed(blurred(labels, settings.blur), settings.noise, random), labels};
  }
} // namespace Stroma::Image
