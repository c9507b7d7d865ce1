#include "orientation.h"

#include "words.h"

#include <stroma/base/errors.h>

#include <cmath>
#include <cstdint>

namespace Stroma::Image
{
  namespace
  {
    /// Largest direction cosine that counts as round-off: .06 degrees.
    constexpr double tolerance = 1e-3;

    using Vector = std::array<double, 3>;

    double
    dot(const Vector &a, const Vector &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    Vector
    cross(const Vector &a, const Vector &b)
    {
      return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
    }

    unsigned int
    main_axis(const Vector &direction)
    {
      unsigned int axis = 0;
      for (unsigned int d = 1; d < 3; ++d)
        if (std::abs(direction[d]) > std::abs(direction[axis]))
          axis = d;
      return axis;
    }
  } // namespace

  bool
  Orientation::is_plain() const
  {
    return axis == std::array<unsigned int, 3>{{0, 1, 2}} && !reversed[0] && !reversed[1] && !reversed[2];
  }

  std::string
  Orientation::text() const
  {
    std::string text;
    for (unsigned int i = 0; i < 3; ++i)
      text += std::string(i == 0 ? "" : ", ") + (reversed[i] ? "-" : "") + axis_names[axis[i]];
    return text;
  }

  void
  check_square(const std::string &path, const Stored &stored)
  {
    for (unsigned int i = 0; i < stored.n_axes; ++i)
      for (unsigned int j = 0; j < i; ++j)
        if (const double cosine = dot(stored.direction[i], stored.direction[j]); !(std::abs(cosine) <= tolerance))
          throw UserError(path, "the image is sheared: its stored axes " + std::to_string(j + 1) + " and " +
                                  std::to_string(i + 1) + " meet at " +
                                  number(std::acos(cosine) * 180 / 3.14159265358979) + " degrees, so its voxels are " +
                                  "no boxes; resample it on a grid of boxes");
  }

  Orientation
  orientation_of(const std::string &path, const Stored &stored)
  {
    check_square(path, stored);
    auto direction = stored.direction;
    if (stored.n_axes == 2)
      direction[2] = cross(direction[0], direction[1]);
    Orientation orientation;
    for (unsigned int i = 0; i < 3; ++i)
      {
        orientation.axis[i]     = main_axis(direction[i]);
        const double along      = direction[i][orientation.axis[i]];
        orientation.reversed[i] = along < 0;
        const double off        = std::sqrt(std::max(0., dot(direction[i], direction[i]) - along * along));
        if (off > tolerance)
          throw UserError(path, "the image is oblique: its stored axis " + std::to_string(i + 1) + " is " +
                                  number(std::asin(std::min(1., off)) * 180 / 3.14159265358979) + " degrees off " +
                                  axis_names[orientation.axis[i]] +
                                  " of its header's coordinates, which are x, y, z here; resample it along them, or "
                                  "set 'Axes = stored' to take the stored axes for x, y, z");
      }
    return orientation;
  }

  template <typename T>
  std::vector<T>
  in_order(const std::vector<T> &stored, std::array<unsigned int, 3> &size, const Orientation &orientation)
  {
    const auto                 stored_size = size;
    std::array<std::size_t, 3> stride;
    for (unsigned int i = 0; i < 3; ++i)
      size[orientation.axis[i]] = stored_size[i];
    const std::array<std::size_t, 3> strides = {{1, size[0], std::size_t(size[0]) * size[1]}};
    for (unsigned int i = 0; i < 3; ++i)
      stride[i] = strides[orientation.axis[i]];
    const auto place = [&](const unsigned int i, const unsigned int index) {
      return (orientation.reversed[i] ? stored_size[i] - 1 - index : index) * stride[i];
    };
    std::vector<T> values(stored.size());
    std::size_t    next = 0;
    for (unsigned int k = 0; k < stored_size[2]; ++k)
      for (unsigned int j = 0; j < stored_size[1]; ++j)
        for (unsigned int i = 0; i < stored_size[0]; ++i)
          values[place(0, i) + place(1, j) + place(2, k)] = stored[next++];
    return values;
  }

  template std::vector<std::uint16_t> in_order(const std::vector<std::uint16_t> &, std::array<unsigned int, 3> &,
                                               const Orientation &);
  template std::vector<float> in_order(const std::vector<float> &, std::array<unsigned int, 3> &, const Orientation &);
} // namespace Stroma::Image
