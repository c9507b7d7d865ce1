#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace Stroma::Image
{
  /// What a zlib or gzip stream, or several in a row, holds; nothing if it is cut off or fails its checksum.
  std::optional<std::string> inflated(const std::string &compressed);

  /// All bytes of a file from byte `first` on, none beyond its end. Throws UserError naming it if it cannot be read.
  std::string file_content(const std::string &path, std::size_t first = 0);
} // namespace Stroma::Image
