#include "formats.h"
#include "tiff_pages.h"
#include "words.h"

#include <stroma/base/counted.h>
#include <stroma/base/errors.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <tiffio.h>

namespace Stroma::Image
{
  namespace
  {
    /// Keeps the first complaint of libtiff, which else goes to standard error, while it lives.
    class Complaints
    {
    public:
      Complaints()
        : error_handler(TIFFSetErrorHandler(keep))
        , warning_handler(TIFFSetWarningHandler(nullptr))
      {
        text().clear();
      }

      ~Complaints()
      {
        TIFFSetErrorHandler(error_handler);
        TIFFSetWarningHandler(warning_handler);
      }

      Complaints(const Complaints &) = delete;

      static std::string &
      text()
      {
        static thread_local std::string complaint;
        return complaint;
      }

    private:
      static void
      keep(const char *, const char *format, va_list arguments)
      {
        char line[300];
        std::vsnprintf(line, sizeof(line), format, arguments);
        if (text().empty())
          text() = readable(line);
      }

      TIFFErrorHandler error_handler, warning_handler;
    };

    [[noreturn]] void
    fail_damaged(const std::string &path, const std::string &reason)
    {
      throw UserError(path, "the image file is cut off or damaged" + (reason.empty() ? "" : " (" + reason + ")") +
                              "; copy it again from its source");
    }

    /// The chain of directories of a TIFF file. libtiff takes a chain that is cut off for a shorter one.
    class Directories
    {
    public:
      explicit Directories(const std::string &path)
        : path(path)
        , stream(path, std::ios::binary)
        , n_bytes(std::filesystem::file_size(path))
      {
        little_endian             = number(0, 1) == 'I';
        const std::uint64_t order = number(0, 2), version = number(2, 2);
        if ((order != 0x4949 && order != 0x4d4d) || (version != 42 && version != 43))
          throw UserError(path, "this is not a TIFF file; give the file its right extension");
        big = version == 43;
      }

      std::size_t
      count()
      {
        std::set<std::uint64_t> visited;
        std::uint64_t           place = big ? number(8, 8) : number(4, 4);
        while (place != 0)
          {
            if (!visited.insert(place).second)
              fail_damaged(path, "its pages go round in a circle");
            const std::uint64_t n_entries = number(place, big ? 8 : 2);
            if (n_entries > 0xffff)
              fail_damaged(path, "a page has too many entries");
            place = number(place + (big ? 8 + 20 * n_entries : 2 + 12 * n_entries), big ? 8 : 4);
          }
        if (visited.empty())
          fail_damaged(path, "it has no page");
        return visited.size();
      }

    private:
      std::uint64_t
      number(const std::uint64_t place, const unsigned int width)
      {
        if (place > n_bytes || width > n_bytes - place)
          fail_damaged(path, "it ends before its last page");
        unsigned char bytes[8];
        stream.seekg(static_cast<std::streamoff>(place));
        stream.read(reinterpret_cast<char *>(bytes), width);
        std::uint64_t value = 0;
        for (unsigned int i = 0; i < width; ++i)
          value = value << 8 | bytes[little_endian ? width - 1 - i : i];
        return value;
      }

      std::string   path;
      std::ifstream stream;
      std::uint64_t n_bytes;
      bool          little_endian = true, big = false;
    };

    /// What a page says about its pixels.
    struct Page
    {
      std::uint32_t width = 0, height = 0;
      std::uint16_t bits = 1, format = SAMPLEFORMAT_UINT, samples = 1, photometric = 1, orientation = 1,
                    compression = 1;
      std::uint32_t subfile     = 0;

      explicit Page(TIFF *tiff)
      {
        TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
        TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
        TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
        TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
        TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
        TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &orientation);
        TIFFGetFieldDefaulted(tiff, TIFFTAG_SUBFILETYPE, &subfile);
        TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
        TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
      }

      std::size_t
      n_bytes() const
      {
        return std::size_t(width) * height * (bits / 8);
      }
    };

    Sample
    sample_of(const std::string &path, const Page &page)
    {
      const Sample u[] = {Sample::u8, Sample::u16, Sample::u32, Sample::u64};
      const Sample s[] = {Sample::i8, Sample::i16, Sample::i32, Sample::i64};
      const Sample f[] = {Sample::u8, Sample::f16, Sample::f32, Sample::f64};
      unsigned int log = 4;
      for (unsigned int i = 0; i < 4; ++i)
        if (page.bits == 8u << i)
          log = i;
      if (log < 4 && (page.format == SAMPLEFORMAT_UINT || page.format == SAMPLEFORMAT_VOID))
        return u[log];
      if (log < 4 && page.format == SAMPLEFORMAT_INT)
        return s[log];
      if (log > 0 && log < 4 && page.format == SAMPLEFORMAT_IEEEFP)
        return f[log];
      const bool complex = page.format == SAMPLEFORMAT_COMPLEXINT || page.format == SAMPLEFORMAT_COMPLEXIEEEFP;
      throw UserError(path, "this TIFF has " + counted(page.bits, "bit") + " a pixel" +
                              (page.format == SAMPLEFORMAT_IEEEFP ? " (floating point)" :
                               complex                            ? " (complex)" :
                                                                    "") +
                              ", allowed are whole numbers of 8, 16, 32 or 64 and floating-point ones of 16, 32 or "
                              "64; convert it");
    }

    void
    check_kind(const std::string &path, const Page &page)
    {
      if (page.samples != 1 || page.photometric > 1)
        throw UserError(path, "this TIFF has colours (" + counted(page.samples, "value") + " a pixel, photometric " +
                                std::to_string(page.photometric) +
                                "), allowed is one grey value; save one channel as 8 or 16 bit grey");
      sample_of(path, page);
      if ((page.subfile & 5) != 0)
        throw UserError(path, "this TIFF holds reduced copies or masks of its pages; save the plain pages only");
      if (page.orientation != ORIENTATION_TOPLEFT)
        throw UserError(path, "this TIFF does not begin at its pages' upper left corner (orientation " +
                                std::to_string(page.orientation) + "); save it with orientation 1");
    }

    void
    check_same(const std::string &path, const Page &first, const Page &page, const std::size_t n)
    {
      if (page.width != first.width || page.height != first.height)
        throw UserError(path, "page " + std::to_string(n) + " has " + std::to_string(page.width) + " x " +
                                std::to_string(page.height) + " pixels, the first " + std::to_string(first.width) +
                                " x " + std::to_string(first.height) + "; all pages of a stack must have one size");
      if (page.bits != first.bits || page.format != first.format || page.photometric != first.photometric)
        throw UserError(path, "page " + std::to_string(n) + " and the first have other kinds of numbers (" +
                                std::to_string(page.bits) + " and " + std::to_string(first.bits) +
                                " bits); all pages of a stack must have one");
    }

    /// Read the pixels of the present page, in strips or tiles, to `target`.
    void
    read_pixels(const std::string &path, TIFF *tiff, const Page &page, char *target)
    {
      const std::size_t width = page.bits / 8, row = page.width * width;
      if (TIFFIsTiled(tiff))
        {
          std::uint32_t tile_width = 0, tile_height = 0;
          TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile_width);
          TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile_height);
          std::string tile(static_cast<std::size_t>(TIFFTileSize(tiff)), '\0');
          if (tile_width == 0 || tile_height == 0 || tile.size() < std::size_t(tile_width) * tile_height * width)
            fail_damaged(path, "it has tiles of no size");
          for (std::uint32_t y = 0; y < page.height; y += tile_height)
            for (std::uint32_t x = 0; x < page.width; x += tile_width)
              {
                if (TIFFReadTile(tiff, tile.data(), x, y, 0, 0) < 0)
                  fail_damaged(path, Complaints::text());
                for (std::uint32_t j = 0; j < std::min(tile_height, page.height - y); ++j)
                  std::memcpy(target + (y + j) * row + x * width, tile.data() + std::size_t(j) * tile_width * width,
                              std::min(tile_width, page.width - x) * width);
              }
          return;
        }
      const std::size_t strip = static_cast<std::size_t>(TIFFStripSize(tiff)), n_bytes = page.n_bytes();
      for (std::size_t done = 0, s = 0; done < n_bytes; done += strip, ++s)
        {
          const std::size_t wanted = std::min(strip, n_bytes - done);
          const auto        got    = strip == 0 ? -1 :
                                                  TIFFReadEncodedStrip(tiff, static_cast<std::uint32_t>(s), target + done,
                                                                       static_cast<tmsize_t>(wanted));
          if (got < 0 || static_cast<std::size_t>(got) != wanted)
            fail_damaged(path, Complaints::text());
        }
    }

    /// Read pixels that follow those of the only page without a directory, as ImageJ writes large stacks.
    void
    read_following(const std::string &path, TIFF *tiff, const Page &page, const std::vector<std::size_t> &planes,
                   std::string &bytes)
    {
      std::uint64_t *offsets = nullptr;
      if (page.compression != COMPRESSION_NONE || TIFFIsTiled(tiff) ||
          TIFFGetField(tiff, TIFFTAG_STRIPOFFSETS, &offsets) == 0 || !offsets)
        throw UserError(path, "the TIFF's description speaks of more pages than it has; save the stack anew");
      const std::uint64_t first = offsets[0];
      std::ifstream       file(path, std::ios::binary);
      for (std::size_t i = 0; i < planes.size(); ++i)
        {
          file.seekg(static_cast<std::streamoff>(first + planes[i] * page.n_bytes()));
          file.read(&bytes[i * page.n_bytes()], static_cast<std::streamsize>(page.n_bytes()));
          if (!file)
            throw UserError(path,
                            "the TIFF's description speaks of more slices than the file holds: it ends in slice " +
                              std::to_string(i + 1) + " of " + std::to_string(planes.size()) +
                              "; copy it again from its source");
        }
      if (TIFFIsByteSwapped(tiff))
        swap_bytes(bytes, page.bits / 8);
    }
  } // namespace

  Stored
  read_tiff(const std::string &path, const Selection &selection)
  {
    const Complaints                                  complaints;
    const std::size_t                                 n_pages = Directories(path).count();
    const std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff(TIFFOpen(path.c_str(), "r"), TIFFClose);
    if (!tiff)
      fail_damaged(path, Complaints::text());
    const Page  first(tiff.get());
    const char *text = nullptr;
    TIFFGetField(tiff.get(), TIFFTAG_IMAGEDESCRIPTION, &text);
    const std::string description = text ? text : "";
    for (std::size_t n = 1; n <= n_pages; ++n)
      {
        const Page page(tiff.get());
        check_kind(path, page);
        check_same(path, first, page, n);
        if (n < n_pages && TIFFReadDirectory(tiff.get()) == 0)
          fail_damaged(path, Complaints::text());
      }
    if (!Complaints::text().empty())
      fail_damaged(path, Complaints::text());

    const TiffPages   pages   = tiff_pages(path, description, n_pages);
    const std::size_t channel = choose(path, "channel", pages.n_channels, selection.channel);
    const std::size_t frame   = choose(path, "frame", pages.n_frames, selection.frame);
    const auto        planes  = pages.slices(channel, frame);
    Stored            stored;
    stored.sample             = sample_of(path, first);
    stored.size               = {{first.width, first.height, planes.size()}};
    stored.n_axes             = planes.size() > 1 ? 3 : 2;
    const std::size_t n_bytes = checked_bytes(path, {double(first.width), double(first.height), double(planes.size())},
                                              stored.sample);
    if (first.photometric == PHOTOMETRIC_MINISWHITE)
      stored.remarks.push_back("0 is white in this TIFF; values are as stored");
    // A compressed page of zeros is some thousand times smaller than its pixels, but not a million times.
    if (n_bytes / 1000000 > std::filesystem::file_size(path))
      fail_damaged(path, "its header speaks of " + counted(n_bytes, "byte") + " of pixels");
    stored.bytes.resize(n_bytes);
    if (pages.one_directory)
      read_following(path, tiff.get(), first, planes, stored.bytes);
    for (std::size_t i = 0; i < planes.size() && !pages.one_directory; ++i)
      {
        if (TIFFSetDirectory(tiff.get(), static_cast<tdir_t>(planes[i])) == 0)
          fail_damaged(path, Complaints::text());
        read_pixels(path, tiff.get(), first, &stored.bytes[i * first.n_bytes()]);
      }
    return stored;
  }
} // namespace Stroma::Image
