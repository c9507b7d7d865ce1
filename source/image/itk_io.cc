#include "itk_io.h"

#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkTIFFImageIO.h>

#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <iostream>
#include <unistd.h>

namespace Stroma::Image
{
  itk::ImageIOBase::Pointer
  writer_of(const std::string &path)
  {
    const std::string extension = std::filesystem::path(path).extension();
    if (extension == ".nrrd")
      return itk::NrrdImageIO::New().GetPointer();
    if (extension == ".mha")
      return itk::MetaImageIO::New().GetPointer();
    return itk::TIFFImageIO::New().GetPointer();
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
