#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

/// Image files made byte by byte, so that the reader is not only tested against the writer.
namespace RawFiles
{
  template <typename T>
  std::string
  bytes(const T value)
  {
    return { reinterpret_cast<const char *>(&value), sizeof(T) };
  }

  template <typename T>
  std::string
  bytes(const std::vector<T> &values)
  {
    return { reinterpret_cast<const char *>(values.data()), values.size() * sizeof(T) };
  }

  /// What a page of a TIFF file says about itself; one strip, little endian.
  struct TiffPage
  {
    unsigned int  width = 2, height = 1, bits = 8, samples = 1, photometric = 1;
    unsigned int  subfile_type = 0;
    bool          tiled        = false;
    std::uint32_t format       = 1;
    std::string   pixels       = std::string(2, '\1');
  };

  inline std::string
  tiff(const std::vector<TiffPage> &pages)
  {
    std::string file = std::string("II") + bytes<std::uint16_t>(42);
    for (const TiffPage &page : pages)
    {
      std::vector<std::pair<std::uint16_t, std::uint32_t>> tags = { { 254, page.subfile_type },
                                                                    { 256, page.width },
                                                                    { 257, page.height },
                                                                    { 258, page.bits },
                                                                    { 259, 1 },
                                                                    { 262, page.photometric },
                                                                    { 273, 0 },
                                                                    { 277, page.samples },
                                                                    { 278, page.height },
                                                                    { 279, std::uint32_t(page.pixels.size()) } };
      if (page.tiled)
        tags.insert(tags.end(), { { 322, 16 }, { 323, 16 } });
      tags.push_back({ 339, page.format });
      const std::uint32_t pixels_at = file.size() + 4;
      tags[6].second                = pixels_at;
      file += bytes<std::uint32_t>(pixels_at + page.pixels.size()) + page.pixels + bytes<std::uint16_t>(tags.size());
      for (const auto &tag : tags)
        file += bytes(tag.first) + bytes<std::uint16_t>(4) + bytes<std::uint32_t>(1) + bytes(tag.second);
    }
    return file + bytes<std::uint32_t>(0);
  }

  inline std::string
  nrrd(const std::string &type, const std::string &sizes, const std::string &spacings, const std::string &voxels)
  {
    const auto n = 1 + std::count(sizes.begin(), sizes.end(), ' ');
    return "NRRD0004\ntype: " + type + "\ndimension: " + std::to_string(n) + "\nsizes: " + sizes
           + "\nspacings: " + spacings + "\nendian: little\nencoding: raw\n\n" + voxels;
  }

  inline std::string
  metaimage(const std::string &type, const std::string &sizes, const std::string &spacings, const std::string &voxels)
  {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nElementSpacing = "
           + spacings + "\nDimSize = " + sizes + "\nElementType = " + type + "\nElementDataFile = LOCAL\n" + voxels;
  }

  /// A NIfTI-1 file of 16 bit unsigned voxels.
  inline std::string
  nifti(const std::vector<std::int16_t> &size, const std::vector<float> &spacing, const std::string &voxels)
  {
    std::string header(352, '\0');
    const auto  put
        = [&header](const std::size_t place, const std::string &value) { header.replace(place, value.size(), value); };
    put(0, bytes<std::int32_t>(348));
    put(40, bytes<std::int16_t>(size.size()) + bytes(size));
    put(70, bytes<std::int16_t>(512) + bytes<std::int16_t>(16));
    put(76, bytes<float>(1) + bytes(spacing));
    put(108, bytes<float>(352));
    put(344, "n+1");
    return header + voxels;
  }
} // namespace RawFiles
