#include "itk_io.h"

#include <stroma/base/errors.h>

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkTIFFImageIO.h>

#include <cstdio>
#include <fcntl.h>
#include <iostream>
#include <unistd.h>

namespace Stroma::Image
{
  namespace
  {
    bool
    ends_with(const std::string &text, const std::string &end)
    {
      return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
    }

    template <typename Format>
    itk::ImageIOBase::Pointer
    create()
    {
      return Format::New().GetPointer();
    }
  } // namespace

  itk::ImageIOBase::Pointer
  image_io(const std::string &path)
  {
    const struct
    {
      const char *extension;
      itk::ImageIOBase::Pointer (*create)();
    } formats[] = { { ".tif", create<itk::TIFFImageIO> },     { ".tiff", create<itk::TIFFImageIO> },
                    { ".nrrd", create<itk::NrrdImageIO> },    { ".nii", create<itk::NiftiImageIO> },
                    { ".nii.gz", create<itk::NiftiImageIO> }, { ".mha", create<itk::MetaImageIO> } };
    std::string known;
    for (const auto &format : formats)
    {
      if (ends_with(path, format.extension))
        return format.create();
      known += std::string(known.empty() ? "" : " ") + format.extension;
    }
    throw UserError(path, "unknown image format; known extensions are " + known);
  }

  Quiet::Quiet()
  {
    std::cerr.flush();
    std::fflush(stderr);
    standard_error    = dup(STDERR_FILENO);
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(nothing, STDERR_FILENO);
    close(nothing);
  }

  Quiet::~Quiet()
  {
    std::cerr.flush();
    std::fflush(stderr);
    dup2(standard_error, STDERR_FILENO);
    close(standard_error);
  }
} // namespace Stroma::Image
