#include "stored.h"

#include "words.h"

#include <stroma/base/counted.h>
#include <stroma/base/errors.h>

#include <algorithm>

namespace Stroma::Image
{
  unsigned int
  bytes_of(const Sample sample)
  {
    switch (sample)
      {
        case Sample::u8:
        case Sample::i8:
          return 1;
        case Sample::u16:
        case Sample::i16:
        case Sample::f16:
          return 2;
        case Sample::u32:
        case Sample::i32:
        case Sample::f32:
          return 4;
        default:
          return 8;
      }
  }

  std::string
  in_words(const Sample sample)
  {
    const std::string bits = std::to_string(8 * bytes_of(sample)) + "-bit ";
    switch (sample)
      {
        case Sample::u8:
        case Sample::u16:
        case Sample::u32:
        case Sample::u64:
          return bits + "unsigned";
        case Sample::i8:
        case Sample::i16:
        case Sample::i32:
        case Sample::i64:
          return bits + "signed";
        default:
          return bits + "floating-point";
      }
  }

  void
  swap_bytes(std::string &bytes, const unsigned int width)
  {
    for (std::size_t i = 0; i + width <= bytes.size(); i += width)
      std::reverse(&bytes[i], &bytes[i] + width);
  }

  std::size_t
  checked_bytes(const std::string &path, const std::vector<double> &size, const Sample sample)
  {
    double n_bytes = bytes_of(sample);
    for (std::size_t d = 0; d < size.size(); ++d)
      {
        if (!(size[d] >= 1 && size[d] <= std::numeric_limits<int>::max()))
          throw UserError(path, "the image has " + number(size[d]) + " voxels along " +
                                  (d < 3 ? std::string(axis_names[d]) : "axis " + std::to_string(d + 1)) +
                                  "; it must be two- or three-dimensional and not empty");
        n_bytes *= size[d];
      }
    if (n_bytes > 1e18)
      throw UserError(path, "the header speaks of " + number(n_bytes) + " bytes of voxels, more than a computer holds");
    return static_cast<std::size_t>(n_bytes);
  }

  std::size_t
  choose(const std::string &path, const std::string &what, const std::size_t n, const unsigned int chosen)
  {
    const std::string name = std::string(1, static_cast<char>(what[0] - 'a' + 'A')) + what.substr(1);
    if (n > 1 && chosen == 0)
      throw UserError(path, "the image has " + std::to_string(n) + " " + what + "s; choose one with the entry '" +
                              name + "', 1 to " + std::to_string(n));
    if (chosen > n)
      throw UserError(path,
                      "the image has " + counted(n, what) + ", '" + name + "' was given as " + std::to_string(chosen));
    return chosen == 0 ? 0 : chosen - 1;
  }

  void
  fail_cut_off(const std::string &path, const std::size_t n_needed, const std::size_t n_found)
  {
    throw UserError(path, "the image file is cut off or damaged: its header speaks of " + counted(n_needed, "byte") +
                            " of voxels, " + grouped(n_found) + " are there; copy it again from its source");
  }
} // namespace Stroma::Image
