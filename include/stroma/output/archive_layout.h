#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>

namespace Stroma::Output
{
  // What the writer and the reader of archives agree on.

  constexpr std::uint64_t archive_format = 7; ///< raised when the layout changes

  /// Dataset with (length, CRC-32) of each rank's block of array @p name.
  inline std::string
  blocks_of(const std::string &name)
  {
    return name + ".blocks";
  }

  /// Scalar dataset of a single value.
  inline std::string
  attribute_path(const std::string &name)
  {
    return "attributes/" + name;
  }

  /// Scalar dataset with the CRC-32 of a single value.
  inline std::string
  checksum_of(const std::string &attribute)
  {
    return attribute + ".checksum";
  }

  /// CRC-32 of a block.
  inline std::uint64_t
  block_checksum(const void *data, const std::size_t bytes)
  {
    return crc32_z(0, static_cast<const Bytef *>(data), bytes);
  }
} // namespace Stroma::Output
