#include <stroma/image/smooth.h>

#include "itk_io.h"
#include "words.h"

#include <stroma/base/errors.h>

#include <itkDiscreteGaussianImageFilter.h>
#include <itkMedianImageFilter.h>

#include <algorithm>

namespace Stroma::Image
{
  namespace
  {
    using FloatImage = itk::Image<float, 3>;
  }

  Volume<float>
  median(const Volume<float> &image, const std::array<unsigned int, 3> &radius)
  {
    auto                           filter = itk::MedianImageFilter<FloatImage, FloatImage>::New();
    itk::Image<float, 3>::SizeType box;
    for (unsigned int d = 0; d < 3; ++d)
      box[d] = image.size[d] == 1 ? 0 : radius[d];
    filter->SetInput(itk_view(image));
    filter->SetRadius(box);
    filter->Update();
    return volume_of(*filter->GetOutput(), image);
  }

  Volume<float>
  gaussian(const Volume<float> &image, const double deviation, const double beyond)
  {
    constexpr double most     = 8; // beyond, ITK's coefficients go wrong: by 1e-4 at 8, 1 % at 12, 28 % at 20
    const double     smallest = *std::min_element(image.voxel_size.begin(), image.voxel_size.end());
    if (!(deviation <= most * smallest))
      throw UserError("a Gaussian of " + number(deviation * 1e6) + " um is wider than " + number(most) +
                      " edges of a voxel of " + number(smallest * 1e6) +
                      " um; make it narrower, or merge voxels first");
    auto filter = itk::DiscreteGaussianImageFilter<FloatImage, FloatImage>::New();
    filter->SetInput(itk_view(image));
    filter->SetVariance(deviation * deviation * 1e12); // in the view's unit, um^2
    filter->SetFilterDimensionality(image.size[2] == 1 ? 2 : 3);
    filter->SetMaximumError(beyond);
    filter->SetMaximumKernelWidth(255);
    filter->Update();
    return volume_of(*filter->GetOutput(), image);
  }
} // namespace Stroma::Image
