#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace Stroma::Image
{
  /// Number types of voxels: unsigned, signed and floating-point, with their bits.
  enum class Sample
  {
    u8,
    i8,
    u16,
    i16,
    u32,
    i32,
    u64,
    i64,
    f16,
    f32,
    f64
  };

  /// Which channel and frame of a file are wanted, counted from 1; 0: there must be only one.
  struct Selection
  {
    unsigned int channel = 0, frame = 0;
  };

  /// One channel and frame of an image file: its voxels as stored and what the header says about them.
  struct Stored
  {
    /// 2 or 3 axes along which voxels are stored, the fastest first.
    unsigned int               n_axes = 3;
    std::array<std::size_t, 3> size   = {{1, 1, 1}};
    /// Distance of voxels along the stored axes, not a number where the header does not say; and its unit, as written.
    std::array<double, 3>      spacing = {{missing, missing, missing}};
    std::array<std::string, 3> unit;
    /// direction[i]: unit vector of stored axis i in the header's coordinates.
    std::array<std::array<double, 3>, 3> direction = {{{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}};
    /// Centre of the first voxel in the header's coordinates, and what NRRD calls these; zero and empty where it does not say.
    std::array<double, 3> origin = {{0, 0, 0}};
    std::string           space;
    /// Why spacing or direction cannot be relied on; empty if they can.
    std::string spacing_fault, direction_fault;

    Sample                   sample = Sample::u8;
    double                   slope = 1, intercept = 0; ///< value = slope * stored + intercept
    std::string              bytes;                    ///< all voxels, in this machine's byte order
    std::vector<std::string> remarks;

    static constexpr double missing = std::numeric_limits<double>::quiet_NaN();

    std::size_t
    n_voxels() const
    {
      return size[0] * size[1] * size[2];
    }
  };

  unsigned int bytes_of(Sample sample);

  /// "16-bit unsigned", for people.
  std::string in_words(Sample sample);

  /// Turn round the bytes of numbers of `width` bytes each.
  void swap_bytes(std::string &bytes, unsigned int width);

  /**
   * Number of bytes of `n` numbers, for sizes from a header that may be anything. Throws UserError naming `path` if one
   * of `size` is not in 1 to 2^31 - 1, or if all together exceed what the memory's addresses count.
   */
  std::size_t checked_bytes(const std::string &path, const std::vector<double> &size, Sample sample);

  /// Check the choice among `n` channels or frames (`what`) and return it, counted from 0. Throws UserError.
  std::size_t choose(const std::string &path, const std::string &what, std::size_t n, unsigned int chosen);

  /// Throws UserError: the file has `n_found` of the `n_needed` bytes that its header speaks of.
  [[noreturn]] void fail_cut_off(const std::string &path, std::size_t n_needed, std::size_t n_found);
} // namespace Stroma::Image
