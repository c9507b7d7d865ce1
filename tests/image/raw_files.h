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
    return {reinterpret_cast<const char *>(&value), sizeof(T)};
  }

  template <typename T>
  std::string
  bytes(const std::vector<T> &values)
  {
    return {reinterpret_cast<const char *>(values.data()), values.size() * sizeof(T)};
  }

  /// What a page of a TIFF file says about itself; one strip, little endian.
  struct TiffPage
  {
    unsigned int  width = 2, height = 1, bits = 8, samples = 1, photometric = 1;
    unsigned int  subfile_type = 0;
    bool          tiled        = false;
    std::uint32_t format       = 1;
    unsigned int  orientation  = 1;
    std::string   pixels       = std::string(2, '\1');
    std::string   description; ///< at least 4 letters
  };

  /// Each page: its pixels, its description, its directory. A tiled page has one tile of 16 x 16 pixels.
  inline std::string
  tiff(const std::vector<TiffPage> &pages)
  {
    struct Entry
    {
      std::uint16_t tag, type;
      std::uint32_t count, value;
    };
    std::string file = std::string("II") + bytes<std::uint16_t>(42);
    for (const TiffPage &page : pages)
      {
        const std::uint32_t pixels_at = file.size() + 4, n_pixels = page.pixels.size(),
                            n_letters = page.description.size();
        std::vector<Entry> entries    = {
             {254, 4, 1, page.subfile_type}, {256, 4, 1, page.width}, {257, 4, 1, page.height},
             {258, 3, 1, page.bits},         {259, 3, 1, 1},          {262, 3, 1, page.photometric}};
        if (!page.description.empty())
          entries.push_back({270, 2, n_letters + 1, pixels_at + n_pixels});
        if (!page.tiled)
          entries.push_back({273, 4, 1, pixels_at});
        entries.push_back({274, 3, 1, page.orientation});
        entries.push_back({277, 3, 1, page.samples});
        if (page.tiled)
          entries.insert(entries.end(),
                         {{322, 4, 1, 16}, {323, 4, 1, 16}, {324, 4, 1, pixels_at}, {325, 4, 1, n_pixels}});
        else
          entries.insert(entries.end(), {{278, 4, 1, page.height}, {279, 4, 1, n_pixels}});
        entries.push_back({339, 3, 1, page.format});
        const std::string text = page.description + '\0';
        file += bytes<std::uint32_t>(pixels_at + n_pixels + text.size()) + page.pixels + text +
                bytes<std::uint16_t>(entries.size());
        for (const Entry &entry : entries)
          file += bytes(entry.tag) + bytes(entry.type) + bytes(entry.count) + bytes(entry.value);
      }
    return file + bytes<std::uint32_t>(0);
  }

  /// A NRRD file; no spacing if `spacings` is empty. `fields`: further lines of the header.
  inline std::string
  nrrd(const std::string &type, const std::string &sizes, const std::string &spacings, const std::string &voxels,
       const std::string &fields = "")
  {
    const auto n = 1 + std::count(sizes.begin(), sizes.end(), ' ');
    return "NRRD0004\ntype: " + type + "\ndimension: " + std::to_string(n) + "\nsizes: " + sizes +
           (spacings.empty() ? "" : "\nspacings: " + spacings) + "\nendian: little\n" + fields +
           (fields.find("encoding") == std::string::npos ? "encoding: raw\n\n" : "\n") + voxels;
  }

  /// A MetaImage; no spacing if `spacings` is empty. `fields`: further lines of the header.
  inline std::string
  metaimage(const std::string &type, const std::string &sizes, const std::string &spacings, const std::string &voxels,
            const std::string &fields = "", const std::string &data_file = "LOCAL")
  {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" + fields +
           (spacings.empty() ? "" : "ElementSpacing = " + spacings + "\n") + "DimSize = " + sizes +
           "\nElementType = " + type + "\nElementDataFile = " + data_file + "\n" + voxels;
  }

  /// What a NIfTI-1 or NIfTI-2 file says; 16 bit unsigned voxels unless said otherwise.
  struct Nifti
  {
    std::vector<std::int16_t> size;
    std::vector<float>        spacing;
    int                       unit = 0, datatype = 512, bits = 16; ///< unit: 0 unknown, 1 m, 2 mm, 3 um
    float                     slope = 0, intercept = 0;
    std::vector<float>        sform = {}; ///< three rows of four, or none
  };

  inline std::string
  nifti(const Nifti &n, const std::string &voxels, const int version = 1)
  {
    const bool  one = version == 1;
    std::string header(one ? 352 : 544, '\0');
    const auto  put = [&header](const std::size_t place, const std::string &value) {
      header.replace(place, value.size(), value);
    };
    const auto whole = [&](const std::int64_t value) {
      return one ? bytes<std::int16_t>(value) : bytes<std::int64_t>(value);
    };
    const auto real = [&](const double value) { return one ? bytes<float>(value) : bytes<double>(value); };
    put(0, bytes<std::int32_t>(one ? 348 : 540));
    std::string dim = whole(n.size.size()), pixdim = real(1), sform;
    for (const auto value : n.size)
      dim += whole(value);
    for (const auto value : n.spacing)
      pixdim += real(value);
    for (const auto value : n.sform)
      sform += real(value);
    put(one ? 40 : 16, dim);
    put(one ? 70 : 12, bytes<std::int16_t>(n.datatype) + bytes<std::int16_t>(n.bits));
    put(one ? 76 : 104, pixdim);
    put(one ? 108 : 168, one ? bytes<float>(352) : bytes<std::int64_t>(544));
    put(one ? 112 : 176, real(n.slope) + real(n.intercept));
    put(one ? 123 : 500, bytes<std::uint8_t>(n.unit));
    if (!sform.empty())
      put(one ? 254 : 348, bytes<std::uint16_t>(1)), put(one ? 280 : 400, sform);
    put(one ? 344 : 4, one ? "n+1" : "n+2");
    return header + voxels;
  }
} // namespace RawFiles
