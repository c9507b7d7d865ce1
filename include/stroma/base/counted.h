#pragma once

#include <string>

// Without a source of its own, for the library of images, which has nothing of deal.II.

namespace Stroma
{
  /// 1234567 -> "1,234,567", for people.
  inline std::string
  grouped(const unsigned long long value)
  {
    std::string text = std::to_string(value);
    for (int place = static_cast<int>(text.size()) - 3; place > 0; place -= 3)
      text.insert(place, ",");
    return text;
  }

  /// 1, "voxel" -> "1 voxel"; 1234, "voxel" -> "1,234 voxels", for people. @param noun one that takes an s
  inline std::string
  counted(const unsigned long long n, const std::string &noun)
  {
    return grouped(n) + " " + noun + (n == 1 ? "" : "s");
  }
} // namespace Stroma
