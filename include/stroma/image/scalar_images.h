#pragma once

#include <stroma/image/frame.h>

#include <memory>
#include <string>
#include <vector>

namespace Stroma::Image
{
  /// File format of images of numbers.
  enum class ScalarFormat
  {
    nrrd, ///< a file a name, raw
    tiff, ///< a file a name, pages as ImageJ has them
    vti   ///< one file for ParaView
  };

  /// What scalar images have in common.
  struct ScalarGrid
  {
    std::array<unsigned int, 3> size;
    std::array<double, 3>       spacing; ///< in units of the frame
    Frame                       frame;
  };

  /**
   * Writes images of single-precision numbers on one grid slice by slice, so that none is ever whole in memory: to
   * <stem>_<name>_<number>.nrrd or .tif each, or to <stem>_<number>.vti together. Throws OutputError. Local.
   */
  class ScalarImages
  {
  public:
    static std::unique_ptr<ScalarImages> make(ScalarFormat format, const std::string &stem, const std::string &number,
                                              const std::vector<std::string> &names, const ScalarGrid &grid);
    virtual ~ScalarImages() = default;

    /// The next slice of image @p i, x fastest.
    virtual void add(std::size_t i, const std::vector<float> &slice) = 0;
    /// After the last slice of all.
    virtual void close() = 0;

    std::vector<std::string> paths; ///< of the files
  };
} // namespace Stroma::Image
