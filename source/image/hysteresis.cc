#include <stroma/image/hysteresis.h>

#include "itk_io.h"
#include "words.h"

#include <stroma/base/errors.h>

#include <itkDoubleThresholdImageFilter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace Stroma::Image
{
  namespace
  {
    /// The smallest value of type T that is not below `threshold`; rounded to the precision of a floating-point image.
    template <typename T>
    T
    as_value(const double threshold)
    {
      const double value = std::max<double>(threshold, std::numeric_limits<T>::lowest());
      return std::is_integral<T>::value ? T(std::ceil(value)) : T(value);
    }

    template <typename T>
    Volume<std::uint8_t>
    plain_threshold(const Volume<T> &image, const T threshold)
    {
      auto mask = volume_like<std::uint8_t>(image, 0);
      std::transform(image.data.begin(), image.data.end(), mask.data.begin(),
                     [&](const T value) { return value >= threshold; });
      return mask;
    }
  } // namespace

  template <typename T>
  Volume<std::uint8_t>
  hysteresis_threshold(const Volume<T> &image, const double lower, const double upper, const Connectivity connectivity)
  {
    if (!(lower <= upper))
      throw UserError("the lower threshold " + number(lower) + " must not be above the upper threshold " +
                      number(upper));
    constexpr T largest = std::numeric_limits<T>::max();
    if (upper > largest)
      return volume_like<std::uint8_t>(image, 0);
    const T seed = as_value<T>(upper), rest = as_value<T>(lower);
    if (seed == rest)
      return plain_threshold(image, seed);

    using Output = itk::Image<std::uint8_t, 3>;
    auto filter  = itk::DoubleThresholdImageFilter<itk::Image<T, 3>, Output>::New();
    filter->SetInput(itk_view(image));
    filter->SetThreshold1(rest);
    filter->SetThreshold2(seed);
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
  template Volume<std::uint8_t> hysteresis_threshold(const Volume<float> &, double, double, Connectivity);
} // namespace Stroma::Image
