#include <stroma/image/overlap.h>

namespace Stroma::Image
{
  std::vector<Overlap>
  overlaps(const std::vector<std::uint8_t> &first, const std::vector<std::uint8_t> &second)
  {
    std::vector<Overlap> found(256);
    for (std::size_t i = 0; i < first.size(); ++i)
      {
        ++found[first[i]].first;
        ++found[second[i]].second;
        if (first[i] == second[i])
          ++found[first[i]].both;
      }
    return found;
  }
} // namespace Stroma::Image
