#include "compressed.h"
#include "formats.h"
#include "words.h"

#include <stroma/base/counted.h>
#include <stroma/base/errors.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>

namespace Stroma::Image
{
  namespace
  {
    /// The entries "key = value" of a MetaImage header, which ends with ElementDataFile.
    class MetaHeader
    {
    public:
      explicit MetaHeader(const std::string &path)
        : path(path)
      {
        std::ifstream file(path, std::ios::binary);
        std::string   line;
        while (entries.count("ElementDataFile") == 0 && std::getline(file, line))
          {
            end += line.size() + 1;
            const auto equals = line.find('=');
            const auto key    = words(line.substr(0, equals));
            if (key.size() != 1 || equals == std::string::npos || entries.size() > 1000)
              break;
            const auto begin = line.find_first_not_of(" \t", equals + 1), last = line.find_last_not_of(" \t\r");
            entries[key[0]] = begin == std::string::npos ? "" : line.substr(begin, last + 1 - begin);
          }
        if (entries.count("ElementDataFile") == 0)
          throw UserError(path, "this is not a MetaImage file, or its header is cut off or damaged: it has no line "
                                "'ElementDataFile ='");
      }

      /// The first of `names` that is given.
      std::string
      text(const std::vector<std::string> &names) const
      {
        for (const auto &name : names)
          if (entries.count(name) > 0)
            return entries.at(name);
        return "";
      }

      /// The numbers of an entry; none if it is not given. UserError if it does not have `n`.
      std::vector<double>
      numbers(const std::vector<std::string> &names, const std::size_t n) const
      {
        std::vector<double> values;
        for (const auto &word : words(text(names)))
          if (const auto value = to_number(word))
            values.push_back(*value);
          else
            fail(names[0], n);
        if (!values.empty() && values.size() != n)
          fail(names[0], n);
        return values;
      }

      bool
      is_true(const std::vector<std::string> &names) const
      {
        const std::string value = lower_case(text(names));
        return value == "true" || value == "t" || value == "1";
      }

      std::string path;
      std::size_t end = 0; ///< first byte after the header

    private:
      [[noreturn]] void
      fail(const std::string &name, const std::size_t n) const
      {
        throw UserError(path, "the header has '" + name + " = " + readable(text({name})) + "'; it must be " +
                                counted(n, "number"));
      }

      std::map<std::string, std::string> entries;
    };

    Sample
    sample_of(const MetaHeader &header)
    {
      static const std::map<std::string, Sample> known = {
        {"MET_CHAR", Sample::i8},        {"MET_UCHAR", Sample::u8},  {"MET_SHORT", Sample::i16},
        {"MET_USHORT", Sample::u16},     {"MET_INT", Sample::i32},   {"MET_UINT", Sample::u32},
        {"MET_LONG", Sample::i32},       {"MET_ULONG", Sample::u32}, {"MET_LONG_LONG", Sample::i64},
        {"MET_ULONG_LONG", Sample::u64}, {"MET_FLOAT", Sample::f32}, {"MET_DOUBLE", Sample::f64}};
      const auto found = known.find(header.text({"ElementType"}));
      if (found == known.end())
        throw UserError(header.path, "the image has 'ElementType = " + readable(header.text({"ElementType"})) +
                                       "', allowed are numbers of 8 to 64 bits; convert it");
      return found->second;
    }

    void
    check_meaning(const MetaHeader &header)
    {
      const auto one = [&](const char *name, const double allowed) {
        const auto values = header.numbers({name}, 1);
        if (!values.empty() && values[0] != allowed)
          throw UserError(header.path, "the header has '" + std::string(name) + " = " + number(values[0]) +
                                         "', which is not handled; convert the image");
      };
      const auto channels = header.numbers({"ElementNumberOfChannels"}, 1);
      if (!channels.empty() && channels[0] != 1)
        throw UserError(header.path, "the image has " + number(channels[0]) +
                                       " components (colours), allowed is one; save one channel as grey");
      one("ElementToIntensityFunctionSlope", 1);
      one("ElementToIntensityFunctionOffset", 0);
      const std::string binary = lower_case(header.text({"BinaryData"}));
      if (!binary.empty() && !header.is_true({"BinaryData"}))
        throw UserError(header.path, "its voxels are written as text; save the image with 'BinaryData = True'");
    }

    /// The bytes of all voxels, inflated.
    std::string
    voxel_bytes(const MetaHeader &header, const std::size_t n_bytes)
    {
      const std::string name  = header.text({"ElementDataFile"});
      const bool        local = lower_case(name) == "local";
      if (words(name).size() != 1 || name.rfind("LIST", 0) == 0 || name.find('%') != std::string::npos)
        throw UserError(header.path, "the voxels are in several files ('ElementDataFile = " + readable(name) +
                                       "'); save the image as one file");
      const std::string file = local ? header.path : (std::filesystem::path(header.path).parent_path() / name).string();
      if (!local && !std::filesystem::is_regular_file(file))
        throw UserError(header.path, "the file of its voxels, " + readable(name) + ", does not exist");
      std::string bytes = file_content(file, local ? header.end : 0);
      if (header.is_true({"CompressedData"}))
        {
          auto content = inflated(bytes);
          if (!content)
            throw UserError(header.path,
                            "the image file is cut off or damaged: its compressed voxels are not whole; copy it "
                            "again from its source");
          bytes = std::move(*content);
        }
      const auto skip = header.numbers({"HeaderSize"}, 1);
      if (!skip.empty() && skip[0] != 0)
        {
          const std::size_t first = skip[0] > 0 ? static_cast<std::size_t>(skip[0]) :
                                                  std::max(bytes.size(), n_bytes) - n_bytes;
          bytes.erase(0, std::min(first, bytes.size()));
        }
      if (bytes.size() < n_bytes)
        fail_cut_off(file, n_bytes, bytes.size());
      bytes.resize(n_bytes);
      return bytes;
    }

    void
    set_directions(const MetaHeader &header, const unsigned int n_dims, Stored &stored)
    {
      const auto matrix = header.numbers({"TransformMatrix", "Orientation", "Rotation"}, std::size_t(n_dims) * n_dims);
      if (matrix.empty())
        return;
      for (unsigned int i = 0; i < std::min(n_dims, 3u); ++i)
        {
          double square = 0;
          for (unsigned int d = 0; d < 3; ++d)
            {
              stored.direction[i][d] = d < n_dims ? matrix[i * n_dims + d] : 0;
              square += stored.direction[i][d] * stored.direction[i][d];
            }
          if (!(std::abs(square - 1) < 1e-3))
            stored.direction_fault = "the header's TransformMatrix has a direction that is not of length 1";
        }
    }
  } // namespace

  Stored
  read_metaimage(const std::string &path, const Selection &selection)
  {
    const MetaHeader header(path);
    const auto       dims = header.numbers({"NDims"}, 1);
    if (dims.empty() || !(dims[0] >= 1 && dims[0] <= 4) || dims[0] != std::floor(dims[0]))
      throw UserError(path, "the header has 'NDims = " + readable(header.text({"NDims"})) + "'; it must be 2 to 4");
    const unsigned int n_dims = static_cast<unsigned int>(dims[0]);
    const auto         size   = header.numbers({"DimSize"}, n_dims);
    for (const double n : size)
      if (n != std::floor(n))
        throw UserError(path, "the header has 'DimSize = " + readable(header.text({"DimSize"})) +
                                "'; sizes are whole numbers");
    if (size.empty())
      throw UserError(path, "the header has no 'DimSize'; the file is cut off or damaged");
    check_meaning(header);
    Stored stored;
    stored.sample              = sample_of(header);
    const std::size_t n_bytes  = checked_bytes(path, size, stored.sample);
    const std::size_t n_frames = n_dims > 3 ? static_cast<std::size_t>(size[3]) : 1;
    const std::size_t frame    = choose(path, "frame", n_frames, selection.frame);
    choose(path, "channel", 1, selection.channel);

    const auto spacing = header.numbers({"ElementSpacing"}, n_dims);
    stored.n_axes      = n_dims < 3 ? 2 : 3;
    for (unsigned int i = 0; i < std::min(n_dims, 3u); ++i)
      {
        stored.size[i]    = static_cast<std::size_t>(size[i]);
        stored.spacing[i] = spacing.empty() ? Stored::missing : spacing[i];
        stored.unit[i]    = header.text({"DistanceUnits"}) == "?" ? "" : header.text({"DistanceUnits"});
      }
    set_directions(header, n_dims, stored);
    stored.bytes = voxel_bytes(header, n_bytes);
    if (n_frames > 1)
      stored.bytes = stored.bytes.substr(frame * (n_bytes / n_frames), n_bytes / n_frames);
    if (header.is_true({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}))
      swap_bytes(stored.bytes, bytes_of(stored.sample));
    return stored;
  }
} // namespace Stroma::Image
