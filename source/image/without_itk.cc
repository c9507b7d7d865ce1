// What images are without ITK (STROMA_ITK=OFF): NIfTI, MetaImage and TIFF are read, the rest is refused.

#include <stroma/base/errors.h>
#include <stroma/image/automatic_threshold.h>
#include <stroma/image/hysteresis.h>
#include <stroma/image/phantom.h>
#include <stroma/image/pieces.h>
#include <stroma/image/smooth.h>
#include <stroma/image/thickness.h>
#include <stroma/image/write.h>

#include "formats.h"

namespace Stroma::Image
{
  namespace
  {
    [[noreturn]] void
    refuse(const std::string &where, const std::string &what)
    {
      throw UserError(where, what + " by ITK, which this build is without; build with 'STROMA_ITK = ON'");
    }
  } // namespace

  Stored
  read_nrrd(const std::string &path, const Selection &)
  {
    refuse(path, "NRRD images are read");
  }

  template <typename T>
  Volume<std::uint8_t>
  hysteresis_threshold(const Volume<T> &, double, double, Connectivity)
  {
    refuse("image", "thresholds are found");
  }

  double
  automatic_threshold(const Histogram &, AutomaticThreshold)
  {
    refuse("image", "thresholds are found");
  }

  Volume<float>
  median(const Volume<float> &, const std::array<unsigned int, 3> &)
  {
    refuse("image", "images are smoothed");
  }

  Volume<float>
  gaussian(const Volume<float> &, double, double)
  {
    refuse("image", "images are smoothed");
  }

  Pieces
  find_pieces(const Volume<std::uint8_t> &, Connectivity)
  {
    refuse("image", "pieces are found");
  }

  void
  close_gaps(Volume<std::uint8_t> &, double)
  {
    refuse("image", "gaps are closed");
  }

  std::vector<double>
  ridge_thickness(const Volume<std::uint8_t> &)
  {
    refuse("image", "thickness is measured");
  }

  Phantom
  make_phantom(const PhantomSettings &)
  {
    refuse("phantom", "phantoms are blurred");
  }

  void
  check_target(const std::string &path, bool)
  {
    refuse(path, "images are written");
  }

  template <typename T>
  void
  write(const std::string &path, const Volume<T> &, bool)
  {
    refuse(path, "images are written");
  }

  template Volume<std::uint8_t> hysteresis_threshold(const Volume<std::uint8_t> &, double, double, Connectivity);
  template Volume<std::uint8_t> hysteresis_threshold(const Volume<std::uint16_t> &, double, double, Connectivity);
  template Volume<std::uint8_t> hysteresis_threshold(const Volume<float> &, double, double, Connectivity);
  template void                 write(const std::string &, const Volume<std::uint8_t> &, bool);
  template void                 write(const std::string &, const Volume<std::uint16_t> &, bool);
} // namespace Stroma::Image
