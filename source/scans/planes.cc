#include <stroma/output/text_file.h>
#include <stroma/scans/planes.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace Stroma::Scans
{
  template <typename T>
  void
  write_planes(const std::string &folder, const std::string &name, const Image::Volume<T> &volume, const double low,
               const double high)
  {
    const std::array<std::array<unsigned int, 3>, 3> planes = {{{{0, 1, 2}}, {{0, 2, 1}}, {{1, 2, 0}}}};
    for (const auto &[right, up, across] : planes)
      {
        if (volume.size[2] == 1 && across != 2)
          continue;
        std::array<unsigned int, 3> i{};
        i[across]        = volume.size[across] / 2;
        std::string text = "P5\n" + std::to_string(volume.size[right]) + " " + std::to_string(volume.size[up]) +
                           "\n255\n";
        for (i[up] = 0; i[up] < volume.size[up]; ++i[up])
          for (i[right] = 0; i[right] < volume.size[right]; ++i[right])
            {
              const double part = (double(volume.at(i[0], i[1], i[2])) - low) / std::max(high - low, 1e-300);
              text += static_cast<char>(std::lround(255 * std::clamp(part, 0., 1.)));
            }
        Output::write_atomically(folder + "/plane_" + std::string{"xyz"[right], "xyz"[up]} + "_" + name + ".pgm", text);
      }
  }

  template void write_planes(const std::string &, const std::string &, const Image::Volume<float> &, double, double);
  template void write_planes(const std::string &, const std::string &, const Image::Volume<std::uint8_t> &, double,
                             double);
} // namespace Stroma::Scans
