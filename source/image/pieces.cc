#include <stroma/image/pieces.h>

#include "itk_io.h"
#include "words.h"

#include <stroma/base/errors.h>

#include <itkBinaryMorphologicalClosingImageFilter.h>
#include <itkConnectedComponentImageFilter.h>

#include <algorithm>
#include <numeric>

namespace Stroma::Image
{
  namespace
  {
    using MaskImage = itk::Image<std::uint8_t, 3>;
    using Ball      = itk::Neighborhood<std::uint8_t, 3>;

    /// The voxels whose centres are within `radius` of the middle one's.
    Ball
    ball(const Volume<std::uint8_t> &mask, const double radius)
    {
      Ball::SizeType size;
      for (unsigned int d = 0; d < 3; ++d)
        size[d] = mask.size[d] == 1 ? 0 : static_cast<unsigned int>(radius / mask.voxel_size[d] * (1 + 1e-9));
      Ball ball;
      ball.SetRadius(size);
      for (unsigned int i = 0; i < ball.Size(); ++i)
        {
          const auto offset  = ball.GetOffset(i);
          double     squared = 0;
          for (unsigned int d = 0; d < 3; ++d)
            squared += std::pow(offset[d] * mask.voxel_size[d], 2);
          ball[i] = squared <= radius * radius * (1 + 1e-9);
        }
      return ball;
    }
  } // namespace

  Pieces
  find_pieces(const Volume<std::uint8_t> &mask, const Connectivity connectivity)
  {
    auto filter = itk::ConnectedComponentImageFilter<MaskImage, itk::Image<std::uint32_t, 3>>::New();
    filter->SetInput(itk_view(mask));
    filter->SetFullyConnected(connectivity == Connectivity::full);
    filter->Update();
    Pieces                   pieces{volume_of(*filter->GetOutput(), mask), {}};
    std::vector<std::size_t> size(filter->GetObjectCount() + 1, 0), first(size.size(), 0);
    for (std::size_t i = pieces.number.data.size(); i-- > 0;)
      {
        ++size[pieces.number.data[i]];
        first[pieces.number.data[i]] = i;
      }
    std::vector<std::uint32_t> order(size.size() - 1), rank(size.size(), 0);
    std::iota(order.begin(), order.end(), 1);
    std::sort(order.begin(), order.end(), [&](const std::uint32_t a, const std::uint32_t b) {
      return size[a] != size[b] ? size[a] > size[b] : first[a] < first[b];
    });
    for (std::size_t i = 0; i < order.size(); ++i)
      {
        rank[order[i]] = static_cast<std::uint32_t>(i + 1);
        pieces.size.push_back(size[order[i]]);
      }
    for (auto &number : pieces.number.data)
      number = rank[number];
    return pieces;
  }

  void
  close_gaps(Volume<std::uint8_t> &mask, const double radius)
  {
    constexpr double most = 50;
    const double     edge = *std::min_element(mask.voxel_size.begin(), mask.voxel_size.end());
    if (radius > most * edge)
      throw UserError("a closing by " + number(radius * 1e6) + " um is wider than " + number(most) +
                      " edges of a voxel; make it smaller, or merge voxels first");
    const Ball structure = ball(mask, radius);
    if (structure.Size() == 1)
      throw UserError("a closing by " + number(radius * 1e6) + " um is less than a voxel and would do nothing");
    auto filter = itk::BinaryMorphologicalClosingImageFilter<MaskImage, MaskImage, Ball>::New();
    filter->SetInput(itk_view(mask));
    filter->SetKernel(structure);
    filter->SetForegroundValue(1);
    filter->SetSafeBorder(true);
    filter->Update();
    mask = volume_of(*filter->GetOutput(), mask);
  }
} // namespace Stroma::Image
