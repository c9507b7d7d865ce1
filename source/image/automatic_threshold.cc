#include <stroma/image/automatic_threshold.h>

#include "words.h"

#include <stroma/base/errors.h>

#include <itkHistogram.h>
#include <itkOtsuThresholdCalculator.h>
#include <itkTriangleThresholdCalculator.h>

namespace Stroma::Image
{
  namespace
  {
    using ItkHistogram = itk::Statistics::Histogram<double>;

    /// With bins of width 1 from 0 on, and an empty one at the end: ITK's triangle looks at the bin behind that it finds.
    ItkHistogram::Pointer
    itk_histogram(const Histogram &histogram)
    {
      auto                                result = ItkHistogram::New();
      const std::size_t                   n      = histogram.count.size() + 1;
      ItkHistogram::SizeType              size(1);
      ItkHistogram::MeasurementVectorType lower(1), upper(1);
      size.Fill(n);
      lower.Fill(0);
      upper.Fill(n);
      result->SetMeasurementVectorSize(1);
      result->Initialize(size, lower, upper);
      for (std::size_t bin = 0; bin + 1 < n; ++bin)
        result->SetFrequency(bin, histogram.count[bin]);
      return result;
    }

    template <typename Calculator>
    double
    threshold_by(const Histogram &histogram)
    {
      auto calculator = Calculator::New();
      calculator->SetInput(itk_histogram(histogram));
      calculator->Update();
      return calculator->GetThreshold();
    }
  } // namespace

  double
  automatic_threshold(const Histogram &histogram, const AutomaticThreshold method)
  {
    if (histogram.count.size() == 1 || histogram.width == 0)
      throw UserError("the image has one value only, " + number(histogram.lowest) + ", which no threshold divides");
    const double     bin      = method == AutomaticThreshold::otsu ?
                                  threshold_by<itk::OtsuThresholdCalculator<ItkHistogram, double>>(histogram) :
                                  threshold_by<itk::TriangleThresholdCalculator<ItkHistogram, double>>(histogram);
    constexpr double rounding = .25; // what is found is an edge or the middle of a bin
    return histogram.edge(static_cast<std::size_t>(bin + rounding));
  }
} // namespace Stroma::Image
