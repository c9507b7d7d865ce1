#pragma once

#include <stroma/image/volume.h>

#include <itkImage.h>
#include <itkImageIOBase.h>

#include <string>

namespace Stroma::Image
{
  /// ITK's writer of the format that the extension of `path` says: .nrrd, .mha, else TIFF.
  itk::ImageIOBase::Pointer writer_of(const std::string &path);

  /// Discards what ITK and the libraries below it print to standard error while it lives: errors are exceptions here.
  class Quiet
  {
  public:
    Quiet();
    ~Quiet();
    Quiet(const Quiet &) = delete;

  private:
    int standard_error;
  };

  /// A view of a volume as an ITK image; nothing is copied, and ITK must not write to it.
  template <typename T>
  typename itk::Image<T, 3>::Pointer
  itk_view(const Volume<T> &volume)
  {
    auto                                   image = itk::Image<T, 3>::New();
    typename itk::Image<T, 3>::SizeType    size;
    typename itk::Image<T, 3>::SpacingType spacing;
    typename itk::Image<T, 3>::PointType   origin;
    for (unsigned int d = 0; d < 3; ++d)
      {
        size[d]    = volume.size[d];
        spacing[d] = volume.voxel_size[d] * 1e6;
        origin[d]  = volume.origin[d] * 1e6 + spacing[d] / 2;
      }
    image->SetRegions(size);
    image->SetSpacing(spacing);
    image->SetOrigin(origin);
    image->GetPixelContainer()->SetImportPointer(const_cast<T *>(volume.data.data()), volume.data.size(), false);
    return image;
  }

  /// The values of an ITK image in the place of `like`.
  template <typename T, typename U>
  Volume<T>
  volume_of(const itk::Image<T, 3> &image, const Volume<U> &like)
  {
    const T *const values = image.GetBufferPointer();
    return {like.size, like.voxel_size, like.origin, std::vector<T>(values, values + like.n_voxels())};
  }
} // namespace Stroma::Image
