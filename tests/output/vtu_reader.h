#pragma once

#include "temporary_folder.h"

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

/// Reads an array of a VTU file with appended, zlib-compressed data: an independent reading of VTK's format.
template <typename T>
std::vector<T>
read_vtu_array(const std::string &path, const std::string &name)
{
  const std::string text  = read_text(path);
  const std::size_t array = text.find("Name=\"" + name + "\"");
  if (array == std::string::npos)
    throw std::runtime_error("no array " + name);
  const std::size_t offset = std::stoul(text.substr(text.find("offset=\"", array) + 8));
  const char       *data   = text.data() + text.find('_', text.find("<AppendedData")) + 1 + offset;

  std::vector<std::uint64_t> head(3);
  std::memcpy(head.data(), data, 24);
  std::vector<std::uint64_t> sizes(head[0]);
  std::memcpy(sizes.data(), data + 24, 8 * sizes.size());
  data += 24 + 8 * sizes.size();

  std::vector<T> values;
  for (std::size_t b = 0; b < sizes.size(); ++b)
    {
      uLongf             n = b + 1 == sizes.size() && head[2] > 0 ? head[2] : head[1];
      std::vector<Bytef> bytes(n);
      if (uncompress(bytes.data(), &n, reinterpret_cast<const Bytef *>(data), sizes[b]) != Z_OK || n != bytes.size())
        throw std::runtime_error("bad block");
      const std::size_t old = values.size();
      values.resize(old + n / sizeof(T));
      std::memcpy(values.data() + old, bytes.data(), n);
      data += sizes[b];
    }
  return values;
}
