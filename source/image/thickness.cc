#include <stroma/image/thickness.h>

#include "itk_io.h"

#include <itkSignedMaurerDistanceMapImageFilter.h>

#include <algorithm>

namespace Stroma::Image
{
  namespace
  {
    /// Distance of each voxel of the mask to the nearest voxel outside, centre to centre [um]; 0 or less outside.
    Volume<float>
    distance_to_outside(const Volume<std::uint8_t> &mask)
    {
      auto outside = volume_like<std::uint8_t>(mask, 0);
      std::transform(mask.data.begin(), mask.data.end(), outside.data.begin(),
                     [](const std::uint8_t m) { return m == 0; });
      using Output = itk::Image<float, 3>;
      auto filter  = itk::SignedMaurerDistanceMapImageFilter<itk::Image<std::uint8_t, 3>, Output>::New();
      filter->SetInput(itk_view(outside));
      filter->SetBackgroundValue(0);
      filter->SetInsideIsPositive(false);
      filter->SetSquaredDistance(false);
      filter->SetUseImageSpacing(true);
      filter->Update();
      return volume_of(*filter->GetOutput(), mask);
    }

    /// Whether no voxel round (x, y, z) has a larger value.
    bool
    is_on_ridge(const Volume<float> &distance, const unsigned int x, const unsigned int y, const unsigned int z)
    {
      const float here = distance.at(x, y, z);
      const auto  past = [&](const unsigned int i, const unsigned int d) { return std::min(i + 2, distance.size[d]); };
      for (unsigned int k = z > 0 ? z - 1 : 0; k < past(z, 2); ++k)
        for (unsigned int j = y > 0 ? y - 1 : 0; j < past(y, 1); ++j)
          for (unsigned int i = x > 0 ? x - 1 : 0; i < past(x, 0); ++i)
            if (distance.at(i, j, k) > here)
              return false;
      return true;
    }
  } // namespace

  std::vector<double>
  ridge_thickness(const Volume<std::uint8_t> &mask)
  {
    if (std::find(mask.data.begin(), mask.data.end(), 0) == mask.data.end())
      return {}; // no end anywhere
    const auto          distance = distance_to_outside(mask);
    const double        edge     = *std::min_element(mask.voxel_size.begin(),
                                                     mask.voxel_size.begin() + (mask.size[2] == 1 ? 2 : 3));
    std::vector<double> thickness;
    for (unsigned int z = 0; z < mask.size[2]; ++z)
      for (unsigned int y = 0; y < mask.size[1]; ++y)
        for (unsigned int x = 0; x < mask.size[0]; ++x)
          if (mask.at(x, y, z) != 0 && is_on_ridge(distance, x, y, z))
            thickness.push_back(2e-6 * distance.at(x, y, z) - edge / 2);
    std::sort(thickness.begin(), thickness.end());
    return thickness;
  }
} // namespace Stroma::Image
