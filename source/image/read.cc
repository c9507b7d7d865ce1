#include <stroma/image/read.h>

#include "itk_io.h"

#include <stroma/base/errors.h>
#include <stroma/image/complete.h>
#include <stroma/image/tiff.h>

#include <itkImageFileReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkTIFFImageIO.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace Stroma::Image
{
  namespace
  {
    constexpr const char *unreadable
        = "the image cannot be read: it is cut off, damaged, too large for the memory or not what its extension says";

    void
    check_file(const std::string &path)
    {
      if (!std::filesystem::exists(path))
        throw UserError(path, "there is no such image file");
      if (!std::filesystem::is_regular_file(path) || !std::ifstream(path))
        throw UserError(path, "this is no readable file; give the path of an image");
    }

    void
    check_layout(const std::string &path, const itk::ImageIOBase &io)
    {
      if (io.GetNumberOfComponents() != 1)
        throw UserError(path, "the image has " + std::to_string(io.GetNumberOfComponents())
                                  + " components (colours), allowed is one; save one channel as 8 or 16 bit grey");
      for (unsigned int d = 0; d < io.GetNumberOfDimensions(); ++d)
        if (io.GetDimensions(d) < 1 || io.GetDimensions(d) > (d < 3 ? std::numeric_limits<int>::max() : 1))
          throw UserError(path, "the image has " + std::to_string(io.GetDimensions(d)) + " voxels along axis "
                                    + std::to_string(d + 1) + "; it must be two- or three-dimensional and not empty");
    }

    template <typename Format>
    bool
    is_a(const itk::ImageIOBase &io)
    {
      return dynamic_cast<const Format *>(&io) != nullptr;
    }

    /// Query the file (size, type, spacing) and check that all of it is there.
    itk::ImageIOBase::Pointer
    open_image(const std::string &path)
    {
      const itk::ImageIOBase::Pointer io      = image_io(path);
      const unsigned int              n_pages = is_a<itk::TIFFImageIO>(*io) ? check_tiff(path) : 0;
      io->SetFileName(path);
      if (!io->CanReadFile(path.c_str()))
        throw UserError(path, unreadable);
      io->ReadImageInformation();
      check_layout(path, *io);
      if (is_a<itk::TIFFImageIO>(*io) && n_pages != (io->GetNumberOfDimensions() > 2 ? io->GetDimensions(2) : 1))
        throw UserError(path, "the TIFF's pages are of several kinds; save the plain pages only");
      if (is_a<itk::NiftiImageIO>(*io))
        check_nifti(path, io->GetImageSizeInBytes());
      if (is_a<itk::MetaImageIO>(*io))
        check_metaimage(path, io->GetImageSizeInBytes());
      return io;
    }

    std::array<double, 3>
    choose_voxel_size(const std::string &path, const itk::ImageIOBase &io,
                      const std::optional<std::array<double, 3>> &given, const double spacing_unit)
    {
      if (!given && is_a<itk::TIFFImageIO>(io))
        throw UserError(path, "the spacing in a TIFF file cannot be trusted; give the entry \"Voxel size\"");
      std::array<double, 3> voxel_size = { { spacing_unit, spacing_unit, spacing_unit } };
      for (unsigned int d = 0; d < 3; ++d)
      {
        if (given)
          voxel_size[d] = (*given)[d];
        else if (d < io.GetNumberOfDimensions())
          voxel_size[d] *= io.GetSpacing(d);
        if (!(voxel_size[d] > 0) || !std::isfinite(voxel_size[d]))
          throw UserError(path, "voxel size " + std::to_string(voxel_size[d]) + " m along axis " + std::to_string(d + 1)
                                    + " is not positive; give the entry \"Voxel size\"");
      }
      return voxel_size;
    }

    /// Read voxels of the file's own type T into 16 bits.
    template <typename T>
    std::vector<std::uint16_t>
    read_values(const std::string &path, itk::ImageIOBase &io)
    {
      auto reader = itk::ImageFileReader<itk::Image<T, 3>>::New();
      reader->SetImageIO(&io);
      reader->SetFileName(path);
      reader->Update();
      const auto    *image  = reader->GetOutput();
      const T *const values = image->GetBufferPointer();
      const T *const end    = values + image->GetLargestPossibleRegion().GetNumberOfPixels();
      if (std::is_signed<T>::value && std::any_of(values, end, [](const T value) { return value < T(0); }))
        throw UserError(path, "the image has negative values, allowed are 0 to 65535; shift or convert it");
      return { values, end };
    }

    std::vector<std::uint16_t>
    read_native(const std::string &path, itk::ImageIOBase &io)
    {
      switch (io.GetComponentType())
      {
      case itk::IOComponentEnum::UCHAR:
        return read_values<unsigned char>(path, io);
      case itk::IOComponentEnum::CHAR:
        return read_values<signed char>(path, io);
      case itk::IOComponentEnum::USHORT:
        return read_values<unsigned short>(path, io);
      case itk::IOComponentEnum::SHORT:
        return read_values<short>(path, io);
      default:
        throw UserError(path, "the image has values of type "
                                  + itk::ImageIOBase::GetComponentTypeAsString(io.GetComponentType())
                                  + ", allowed are 8 and 16 bit integers; convert it");
      }
    }
  } // namespace

  Volume<std::uint16_t>
  read(const std::string &path, const std::optional<std::array<double, 3>> &voxel_size, const double spacing_unit)
  {
    check_file(path);
    const Quiet quiet;
    try
    {
      const itk::ImageIOBase::Pointer io = open_image(path);
      Volume<std::uint16_t>           volume;
      for (unsigned int d = 0; d < 3; ++d)
        volume.size[d] = d < io->GetNumberOfDimensions() ? io->GetDimensions(d) : 1;
      volume.voxel_size = choose_voxel_size(path, *io, voxel_size, spacing_unit);
      volume.data       = read_native(path, *io);
      if (volume.data.size() != volume.n_voxels())
        throw UserError(path, unreadable);
      return volume;
    }
    catch (const UserError &)
    {
      throw;
    }
    catch (const std::exception &)
    {
      throw UserError(path, unreadable);
    }
  }
} // namespace Stroma::Image
