#include "compressed.h"

#include <stroma/base/errors.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>
#include <zlib.h>

namespace Stroma::Image
{
  std::optional<std::string>
  inflated(const std::string &compressed)
  {
    z_stream stream = {};
    if (inflateInit2(&stream, MAX_WBITS + 32) != Z_OK)
      return std::nullopt;
    std::vector<unsigned char> buffer(1 << 18);
    std::string                content;
    std::size_t                fed    = 0;
    int                        status = Z_OK;
    while (status == Z_OK)
      {
        if (stream.avail_in == 0)
          {
            const auto part = std::min<std::size_t>(compressed.size() - fed, 1 << 30);
            stream.next_in  = reinterpret_cast<unsigned char *>(const_cast<char *>(compressed.data() + fed));
            stream.avail_in = static_cast<unsigned int>(part);
            fed += part;
          }
        stream.next_out  = buffer.data();
        stream.avail_out = static_cast<unsigned int>(buffer.size());
        status           = inflate(&stream, Z_NO_FLUSH);
        content.append(reinterpret_cast<char *>(buffer.data()), buffer.size() - stream.avail_out);
        const bool more = stream.avail_in > 1 && stream.next_in[0] == 0x1f && stream.next_in[1] == 0x8b;
        if (status == Z_STREAM_END && more)
          status = inflateReset(&stream);
      }
    inflateEnd(&stream);
    return status == Z_STREAM_END ? std::optional<std::string>(std::move(content)) : std::nullopt;
  }

  std::string
  file_content(const std::string &path, const std::size_t first)
  {
    std::ifstream file(path, std::ios::binary);
    std::string   content;
    if (file.seekg(0, std::ios::end))
      {
        const auto size = static_cast<std::size_t>(file.tellg());
        content.resize(size - std::min(first, size));
        file.seekg(static_cast<std::streamoff>(first));
        file.read(content.data(), static_cast<std::streamsize>(content.size()));
      }
    if (!file)
      throw UserError(path, "this file cannot be read; check that it exists and may be read");
    return content;
  }
} // namespace Stroma::Image
