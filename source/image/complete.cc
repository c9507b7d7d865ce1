#include <stroma/base/errors.h>
#include <stroma/image/complete.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <vector>
#include <zlib.h>

namespace Stroma::Image
{
  namespace
  {
    [[noreturn]] void
    fail(const std::string &path)
    {
      throw UserError(path, "the image file is cut off or damaged; copy it again from its source");
    }

    /// Where a NIfTI-1 header says the voxels begin: a float at byte 108, in the byte order of the header's size, 348.
    double
    nifti_voxel_offset(const std::vector<unsigned char> &header)
    {
      std::uint32_t size, bits;
      std::memcpy(&size, header.data(), 4);
      std::memcpy(&bits, header.data() + 108, 4);
      if (size != 348)
        bits = __builtin_bswap32(bits);
      float offset;
      std::memcpy(&offset, &bits, 4);
      return offset;
    }

    /// Number of bytes that a zlib stream holds; 0 if it is damaged or cut off.
    std::uint64_t
    inflated_size(std::string &compressed)
    {
      z_stream stream = {};
      if (inflateInit2(&stream, MAX_WBITS + 32) != Z_OK)
        return 0;
      stream.next_in  = reinterpret_cast<unsigned char *>(&compressed[0]);
      stream.avail_in = compressed.size();
      std::vector<unsigned char> buffer(1 << 16);
      std::uint64_t              n_bytes = 0;
      int                        status  = Z_OK;
      while (status == Z_OK)
      {
        stream.next_out  = buffer.data();
        stream.avail_out = buffer.size();
        status           = inflate(&stream, Z_NO_FLUSH);
        n_bytes += buffer.size() - stream.avail_out;
      }
      inflateEnd(&stream);
      return status == Z_STREAM_END ? n_bytes : 0;
    }

    /// The entries "key = value" up to the last one of a MetaImage header, ElementDataFile.
    std::map<std::string, std::string>
    metaimage_header(std::istream &file)
    {
      std::map<std::string, std::string> entries;
      std::string                        line;
      while (entries.count("ElementDataFile") == 0 && std::getline(file, line))
      {
        line.erase(std::remove_if(line.begin(), line.end(), [](const char c) { return c == ' ' || c == '\r'; }),
                   line.end());
        const auto equals               = line.find('=');
        entries[line.substr(0, equals)] = equals == std::string::npos ? "" : line.substr(equals + 1);
      }
      return entries;
    }
  } // namespace

  void
  check_nifti(const std::string &path, const std::uint64_t n_bytes)
  {
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
    std::vector<unsigned char>                       buffer(1 << 16);
    int                                              n_read = file ? gzread(file.get(), buffer.data(), 348) : -1;
    if (n_read != 348)
      fail(path);
    const double  needed = nifti_voxel_offset(buffer) + n_bytes;
    std::uint64_t total  = 0;
    for (; n_read > 0; n_read = gzread(file.get(), buffer.data(), buffer.size()))
      total += n_read;
    int error;
    gzerror(file.get(), &error);
    if (n_read < 0 || error != Z_OK || !(needed <= total))
      fail(path);
  }

  void
  check_metaimage(const std::string &path, const std::uint64_t n_bytes)
  {
    std::ifstream file(path, std::ios::binary);
    auto          header = metaimage_header(file);
    if (header["ElementDataFile"] != "LOCAL" && header["ElementDataFile"] != "local")
      throw UserError(path, "the voxels are not in the .mha file itself; save the image as one file");
    std::string voxels{ std::istreambuf_iterator<char>(file), {} };
    const char  compressed = header["CompressedData"][0]; // True, true, 1 or absent
    const bool complete = compressed == 'T' || compressed == 't' || compressed == '1' ? inflated_size(voxels) == n_bytes
                                                                                      : voxels.size() >= n_bytes;
    if (!complete)
      fail(path);
  }
} // namespace Stroma::Image
