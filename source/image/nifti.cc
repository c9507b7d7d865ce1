#include "formats.h"
#include "words.h"

#include <stroma/base/errors.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <zlib.h>

namespace Stroma::Image
{
  namespace
  {
    /// The first bytes of a NIfTI file; places differ between NIfTI-1 and NIfTI-2.
    class NiftiHeader
    {
    public:
      NiftiHeader(const std::string &path, const std::string &bytes)
        : bytes(bytes)
      {
        if (bytes.size() < 348)
          throw UserError(path, "the image file is cut off: it is shorter than a NIfTI header; copy it again from its "
                                "source");
        for (const bool swap : {false, true})
          {
            swapped           = swap;
            const double size = at<std::int32_t>(0);
            version           = size == 348 ? 1 : size == 540 ? 2 : 0;
            if (version != 0)
              break;
          }
        const std::string magic = version == 1 ? bytes.substr(344, 4) :
                                  version == 2 ? bytes.substr(4, 4) :
                                                 std::string(4, '\0');
        if (magic.compare(0, 3, "ni1") == 0 || magic.compare(0, 3, "ni2") == 0)
          throw UserError(path, "the voxels are in another file (.img); save the image as one .nii file");
        if (magic.compare(0, 3, version == 1 ? "n+1" : "n+2") != 0 || (version == 2 && bytes.size() < 540))
          throw UserError(path, "this is not a NIfTI file, or it is damaged; give the file its right extension");
      }

      double
      dim(const unsigned int i) const
      {
        return version == 1 ? at<std::int16_t>(40 + 2 * i) : at<std::int64_t>(16 + 8 * i);
      }

      int
      datatype() const
      {
        return static_cast<int>(at<std::int16_t>(version == 1 ? 70 : 12));
      }

      double
      pixdim(const unsigned int i) const
      {
        return real(76, 104, i);
      }

      double
      voxel_offset() const
      {
        return version == 1 ? at<float>(108) : at<std::int64_t>(168);
      }

      double
      slope() const
      {
        return real(112, 176, 0);
      }

      double
      intercept() const
      {
        return real(116, 184, 0);
      }

      int
      unit_code() const
      {
        return (version == 1 ? static_cast<unsigned char>(bytes[123]) : static_cast<int>(at<std::int32_t>(500))) & 7;
      }

      bool
      has_qform() const
      {
        return (version == 1 ? at<std::int16_t>(252) : at<std::int32_t>(344)) > 0;
      }

      bool
      has_sform() const
      {
        return (version == 1 ? at<std::int16_t>(254) : at<std::int32_t>(348)) > 0;
      }

      /// b, c, d of the rotation's quaternion.
      double
      quaternion(const unsigned int i) const
      {
        return real(256, 352, i);
      }

      double
      sform(const unsigned int row, const unsigned int column) const
      {
        return real(280, 400, 4 * row + column);
      }

      bool swapped = false;

    private:
      /// Number i of a row that begins at these places.
      double
      real(const std::size_t place_1, const std::size_t place_2, const unsigned int i) const
      {
        return version == 1 ? at<float>(place_1 + 4 * i) : at<double>(place_2 + 8 * i);
      }

      template <typename T>
      double
      at(const std::size_t place) const
      {
        std::string part = bytes.substr(place, sizeof(T));
        if (swapped)
          std::reverse(part.begin(), part.end());
        T value;
        std::memcpy(&value, part.data(), sizeof(T));
        return static_cast<double>(value);
      }

      const std::string &bytes;
      int                version = 0;
    };

    Sample
    sample_of_datatype(const std::string &path, const int datatype)
    {
      static const std::map<int, Sample> known = {{2, Sample::u8},    {4, Sample::i16},   {8, Sample::i32},
                                                  {16, Sample::f32},  {64, Sample::f64},  {256, Sample::i8},
                                                  {512, Sample::u16}, {768, Sample::u32}, {1024, Sample::i64},
                                                  {1280, Sample::u64}};
      const auto                         found = known.find(datatype);
      if (found != known.end())
        return found->second;
      if (datatype == 128 || datatype == 2304)
        throw UserError(path, "the image has colours (NIfTI data type " + std::to_string(datatype) +
                                "), allowed is one grey value; save one channel");
      throw UserError(path, "the image has values of NIfTI data type " + std::to_string(datatype) +
                              ", allowed are real numbers of 8 to 64 bits; convert it");
    }

    using Vector = std::array<double, 3>;

    /// Columns of the rotation that the quaternion says. Source: nifti1.h, "METHOD 2".
    std::array<Vector, 3>
    qform_directions(const NiftiHeader &header)
    {
      const double b = header.quaternion(0), c = header.quaternion(1), d = header.quaternion(2);
      const double a    = std::sqrt(std::max(0., 1 - b * b - c * c - d * d));
      const double qfac = header.pixdim(0) < 0 ? -1 : 1;
      return {{{{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)}},
               {{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)}},
               {{qfac * 2 * (b * d + a * c), qfac * 2 * (c * d - a * b), qfac * (a * a + d * d - b * b - c * c)}}}};
    }

    /// Columns of the sform at unit length. Source: nifti1.h, "METHOD 3".
    std::array<Vector, 3>
    sform_directions(const NiftiHeader &header, Stored &stored)
    {
      std::array<Vector, 3> directions;
      for (unsigned int j = 0; j < 3; ++j)
        {
          double square = 0;
          for (unsigned int i = 0; i < 3; ++i)
            {
              directions[j][i] = header.sform(i, j);
              square += directions[j][i] * directions[j][i];
            }
          const double length = std::sqrt(square);
          for (double &component : directions[j])
            component /= length;
          if (j < stored.n_axes && !(length > 0))
            stored.direction_fault = "the header's sform has a direction of no length";
          else if (j < stored.n_axes && !(std::abs(length - stored.spacing[j]) <= 1e-3 * length))
            stored.spacing_fault = "the header contradicts itself: along stored axis " + std::to_string(j + 1) +
                                   " voxels are " + number(length) + " apart by the sform and " +
                                   number(stored.spacing[j]) + " by pixdim";
        }
      return directions;
    }

    void
    set_directions(const NiftiHeader &header, Stored &stored)
    {
      if (header.has_qform())
        stored.direction = qform_directions(header);
      if (!header.has_sform())
        return;
      const auto directions = sform_directions(header, stored);
      for (unsigned int j = 0; j < stored.n_axes && header.has_qform(); ++j)
        for (unsigned int i = 0; i < 3; ++i)
          if (std::abs(directions[j][i] - stored.direction[j][i]) > .5)
            stored
              .direction_fault = "the header contradicts itself: its sform and qform give the voxels other directions";
      stored.direction = directions;
    }

    /// Bytes of a file, plain or gzip, in turn.
    class Reader
    {
    public:
      explicit Reader(const std::string &path)
        : path(path)
        , file(gzopen(path.c_str(), "rb"), gzclose)
      {}

      /// Up to `n` bytes more.
      std::string
      take(const std::size_t n)
      {
        std::string bytes;
        while (bytes.size() < n)
          {
            const std::size_t before = bytes.size(), part = std::min<std::size_t>(n - before, 1 << 24);
            bytes.resize(before + part);
            const int got = file ? gzread(file.get(), &bytes[before], static_cast<unsigned int>(part)) : -1;
            bytes.resize(before + std::max(got, 0));
            if (got <= 0)
              break;
          }
        return bytes;
      }

      /// Read `n` bytes without keeping them and return how many there were.
      std::size_t
      skip(const std::size_t n)
      {
        std::size_t n_read = 0;
        while (n_read < n)
          {
            const std::size_t got = take(std::min<std::size_t>(n - n_read, 1 << 24)).size();
            if (got == 0)
              break;
            n_read += got;
          }
        return n_read;
      }

      /// Read to the end, where gzip has its checksum.
      void
      check_end()
      {
        skip(std::numeric_limits<std::size_t>::max());
        int               error;
        const std::string report = gzerror(file.get(), &error); // "path: reason"
        if (error != Z_OK)
          throw UserError(path, "the image file is cut off or damaged (" +
                                  readable(report.substr(report.rfind(':') + 1)) + "); copy it again from its source");
      }

    private:
      std::string                                path;
      std::unique_ptr<gzFile_s, int (*)(gzFile)> file;
    };

    /**
     * The `block` bytes of one channel and frame, `before` bytes after the first of all `n_bytes` of voxels.
     * `first`: what was taken from the file for the header; voxels, from byte `voxel_offset` on, may begin among it.
     */
    std::string
    read_block(const std::string &path, Reader &file, const std::string &first, const double voxel_offset,
               const std::size_t n_bytes, const std::size_t block, const std::size_t before)
    {
      if (!(voxel_offset >= 348 && voxel_offset < 1e15))
        throw UserError(path, "the header says that voxels begin at byte " + number(voxel_offset) +
                                ", which cannot be; the file is damaged");
      const std::size_t offset = static_cast<std::size_t>(voxel_offset);
      std::string       early  = offset < first.size() ? first.substr(offset) : "";
      std::size_t       n_read = early.size();
      if (offset > first.size())
        file.skip(offset - first.size());
      if (before > n_read)
        {
          n_read += file.skip(before - n_read);
          early.clear();
        }
      else
        early.erase(0, before);
      std::string       bytes = early.substr(0, block);
      const std::string rest  = file.take(block - bytes.size());
      bytes += rest;
      n_read += rest.size();
      n_read += file.skip(n_bytes > n_read ? n_bytes - n_read : 0);
      if (n_read < n_bytes || bytes.size() != block)
        fail_cut_off(path, n_bytes, n_read);
      return bytes;
    }
  } // namespace

  Stored
  read_nifti(const std::string &path, const Selection &selection)
  {
    Reader            file(path);
    const std::string first = file.take(540);
    const NiftiHeader header(path, first);
    const double      n_dims = header.dim(0);
    if (!(n_dims >= 1 && n_dims <= 7))
      throw UserError(path, "the image has " + number(n_dims) + " dimensions; the file is damaged or no NIfTI");
    std::vector<double> size;
    for (unsigned int i = 1; i <= 7; ++i)
      size.push_back(i <= n_dims ? header.dim(i) : 1);
    Stored stored;
    stored.sample             = sample_of_datatype(path, header.datatype());
    const std::size_t n_bytes = checked_bytes(path, size, stored.sample);
    if (size[5] * size[6] != 1)
      throw UserError(path, "the image has " + number(n_dims) + " dimensions; allowed are x, y, z, time and channel");
    const std::size_t frame   = choose(path, "frame", static_cast<std::size_t>(size[3]), selection.frame);
    const std::size_t channel = choose(path, "channel", static_cast<std::size_t>(size[4]), selection.channel);

    stored.n_axes = n_dims < 3 ? 2 : 3;
    for (unsigned int i = 0; i < 3; ++i)
      {
        stored.size[i]    = static_cast<std::size_t>(size[i]);
        stored.spacing[i] = i < stored.n_axes && header.pixdim(i + 1) != 0 ? header.pixdim(i + 1) : Stored::missing;
        stored.unit[i]    = std::array<const char *, 8>{
             {"", "m", "mm", "um", "code 4", "code 5", "code 6", "code 7"}}[header.unit_code()];
      }
    set_directions(header, stored);
    if (header.slope() != 0 && std::isfinite(header.slope()) && std::isfinite(header.intercept()))
      {
        stored.slope     = header.slope();
        stored.intercept = header.intercept();
        if (stored.slope != 1 || stored.intercept != 0)
          stored.remarks.push_back("values are " + number(stored.slope) + " times the stored ones, plus " +
                                   number(stored.intercept) + " (header)");
      }

    const auto block = n_bytes / static_cast<std::size_t>(size[3] * size[4]);
    stored.bytes     = read_block(path, file, first, header.voxel_offset(), n_bytes, block,
                                  block * (channel * static_cast<std::size_t>(size[3]) + frame));
    file.check_end();
    if (header.swapped)
      swap_bytes(stored.bytes, bytes_of(stored.sample));
    return stored;
  }
} // namespace Stroma::Image
