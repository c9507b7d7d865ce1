#include <stroma/image/segment.h>

#include "itk_io.h"

#include <stroma/base/errors.h>

#include <itkDoubleThresholdImageFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace Stroma::Image
{
  template <typename T>
  Volume<std::uint8_t>
  hysteresis_threshold(const Volume<T> &image, const double lower, const double upper, const Connectivity connectivity)
  {
    if (!(lower <= upper))
      throw UserError("the lower threshold " + std::to_string(lower) + " must not be above the upper threshold "
                      + std::to_string(upper));
    constexpr T largest = std::numeric_limits<T>::max();
    if (upper > largest)
      return volume_like<std::uint8_t>(image, 0);

    using Output = itk::Image<std::uint8_t, 3>;
    auto filter  = itk::DoubleThresholdImageFilter<itk::Image<T, 3>, Output>::New();
    filter->SetInput(itk_view(image));
    filter->SetThreshold1(T(std::ceil(std::max(lower, 0.))));
    filter->SetThreshold2(T(std::ceil(std::max(upper, 0.))));
    filter->SetThreshold3(largest);
    filter->SetThreshold4(largest);
    filter->SetInsideValue(1);
    filter->SetOutsideValue(0);
    filter->SetFullyConnected(connectivity == Connectivity::full);
    filter->Update();
    return volume_of(*filter->GetOutput(), image);
  }

  template Volume<std::uint8_t> hysteresis_threshold(const Volume<std::uint8_t> &, double, double, Connectivity);
  template Volume<std::uint8_t> hysteresis_threshold(const Volume<std::uint16_t> &, double, double, Connectivity);
} // namespace Stroma::Image
