#pragma once

#include <stroma/image/frame.h>
#include <stroma/image/volume.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace Stroma::Image
{
  /// What is said about an image file besides what it says itself.
  struct ReadOptions
  {
    /// Edge lengths of a voxel along x, y, z of the result [m]; they go before the file's own.
    std::optional<std::array<double, 3>> voxel_size;
    /// Length of one unit of the file's spacing [m]; refused if the file names another unit.
    std::optional<double> spacing_unit;
    /// x, y, z of the result are the axes along which voxels are stored, whatever the header says of their directions.
    bool stored_axes = false;
    /// The image is for a plane scene: a two-dimensional file needs no edge along z.
    bool plane = false;
    /// Which channel and frame of several, counted from 1; 0: the file must have only one.
    unsigned int channel = 0, frame = 0;
  };

  /// A volume with remarks on how the file was understood, for people.
  template <typename T>
  struct ReadVolume : Volume<T>
  {
    std::vector<std::string> remarks;
    Frame                    frame; ///< of NRRD also its origin; else the first voxel is at zero
    std::string              type;  ///< of the numbers in the file, "16-bit unsigned" for example
  };

  /**
   * Read a volume image or a single slice: TIFF stack (.tif, .tiff; also ImageJ's and OME's), NRRD (.nrrd, .nhdr),
   * NIfTI-1 and -2 (.nii, .nii.gz) or MetaImage (.mha, .mhd), in small or capital letters. The number type may be any
   * whole or floating-point one; a NIfTI's scaling is applied.
   *
   * T = std::uint16_t reads labels: all values must be whole and 0 to 65535. T = float reads grey values: all must be
   * finite.
   *
   * Axes: x, y, z of the result are the coordinates of the file's header (NIfTI: to the right, front and top; NRRD and
   * MetaImage: as their space says), so that voxels stored along other axes, or backwards, are put in order. Without
   * directions, as in TIFF, they are the order of storage. The result's corner is at zero: the header's origin is kept in
   * `frame` only.
   *
   * Unit of length: as the header says; if it says none, `spacing_unit` or else 1e-6 m. A MetaImage that names no unit
   * needs `spacing_unit`, since its convention is the millimetre. TIFF files, and files without a spacing, need
   * `voxel_size`.
   *
   * Throws UserError, naming the file and the reason, for whatever cannot be read as it is meant: a file that is
   * missing, cut off or damaged, several components, channels or frames without a choice, values that are no labels,
   * oblique or sheared axes, units that contradict each other. A path that the file system refuses throws
   * std::filesystem::filesystem_error.
   */
  template <typename T = std::uint16_t>
  ReadVolume<T> read(const std::string &path, const ReadOptions &options = ReadOptions());

  extern template ReadVolume<std::uint16_t> read(const std::string &, const ReadOptions &);
  extern template ReadVolume<float>         read(const std::string &, const ReadOptions &);
} // namespace Stroma::Image
