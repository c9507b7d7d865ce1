#include "values.h"

#include "words.h"

#include <stroma/base/errors.h>

#include <cmath>
#include <cstring>

namespace Stroma::Image
{
  namespace
  {
    /// IEEE 754 half precision.
    struct Half
    {
      std::uint16_t bits;

      explicit operator double() const
      {
        const int    exponent = bits >> 10 & 31, fraction = bits & 1023;
        const double size = exponent == 0  ? std::ldexp(fraction, -24) :
                            exponent == 31 ? (fraction == 0 ? HUGE_VAL : std::nan("")) :
                                             std::ldexp(1024 + fraction, exponent - 25);
        return (bits & 0x8000) != 0 ? -size : size;
      }
    };

    [[noreturn]] void
    refuse_label(const std::string &place, const double value)
    {
      const bool fits = value >= 0 && value <= 65535;
      throw UserError(place + " is " + number(value) + ": " +
                      (value < 0 ? "negative values are no labels" :
                       fits      ? "labels are whole numbers" :
                                   "labels are whole numbers up to 65535") +
                      "; shift or convert the image, or set 'Interpretation = threshold' for grey values");
    }

    /// `value` as a T; UserError if it is no label or grey value. `error`: how far it may be off by the scaling.
    template <typename T, typename Place>
    T
    checked(const double value, const double error, const Place &place)
    {
      if constexpr (std::is_floating_point<T>::value)
        {
          if (!std::isfinite(static_cast<T>(value)))
            throw UserError(place() + " is " + number(value) + "; grey values must be finite numbers");
          return static_cast<T>(value);
        }
      else
        {
          const double whole = std::nearbyint(value);
          if (!(std::abs(value - whole) <= error) || !(whole >= 0) || whole > std::numeric_limits<T>::max())
            refuse_label(place(), value);
          return static_cast<T>(whole);
        }
    }

    template <typename Raw, typename T>
    std::vector<T>
    convert(const std::string &path, const Stored &stored)
    {
      const bool     scaled = stored.slope != 1 || stored.intercept != 0;
      std::vector<T> values(stored.n_voxels());
      for (std::size_t i = 0; i < values.size(); ++i)
        {
          Raw raw;
          std::memcpy(&raw, stored.bytes.data() + i * sizeof(Raw), sizeof(Raw));
          const double unscaled = static_cast<double>(raw), value = stored.slope * unscaled + stored.intercept;
          // Slope and intercept are single-precision numbers in most headers.
          const double error = scaled ? 1e-6 * (std::abs(stored.slope * unscaled) + std::abs(stored.intercept)) : 0.;
          values[i]          = checked<T>(scaled ? value : unscaled, error, [&] {
            const std::size_t row = i / stored.size[0];
            return path + ": the value of voxel " + std::to_string(i % stored.size[0]) + ", " +
                   std::to_string(row % stored.size[1]) + ", " + std::to_string(row / stored.size[1]) +
                   " (stored order, from 0)";
          });
        }
      return values;
    }
  } // namespace

  template <typename T>
  std::vector<T>
  values_of(const std::string &path, const Stored &stored)
  {
    switch (stored.sample)
      {
        case Sample::u8:
          return convert<std::uint8_t, T>(path, stored);
        case Sample::i8:
          return convert<std::int8_t, T>(path, stored);
        case Sample::u16:
          return convert<std::uint16_t, T>(path, stored);
        case Sample::i16:
          return convert<std::int16_t, T>(path, stored);
        case Sample::u32:
          return convert<std::uint32_t, T>(path, stored);
        case Sample::i32:
          return convert<std::int32_t, T>(path, stored);
        case Sample::u64:
          return convert<std::uint64_t, T>(path, stored);
        case Sample::i64:
          return convert<std::int64_t, T>(path, stored);
        case Sample::f16:
          return convert<Half, T>(path, stored);
        case Sample::f32:
          return convert<float, T>(path, stored);
        default:
          return convert<double, T>(path, stored);
      }
  }

  template std::vector<std::uint16_t> values_of(const std::string &, const Stored &);
  template std::vector<float>         values_of(const std::string &, const Stored &);
} // namespace Stroma::Image
