#include <stroma/base/errors.h>
#include <stroma/image/tiff.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <vector>

namespace Stroma::Image
{
  namespace
  {
    /// The tags of a page that matter here, with their numbers in the file.
    enum Tag : unsigned int
    {
      subfile_type      = 254,
      width             = 256,
      height            = 257,
      bits_per_sample   = 258,
      photometric       = 262,
      strip_offsets     = 273,
      samples_per_pixel = 277,
      strip_byte_counts = 279,
      tile_width        = 322
    };

    /// Values of the tags above in one page.
    using Page = std::map<unsigned int, std::vector<std::uint64_t>>;

    constexpr const char *cut_off = "the file is cut off or damaged; copy it again from its source";

    /// Numbers of a TIFF file by place and width, in the file's byte order.
    class TiffFile
    {
    public:
      explicit TiffFile(const std::string &path)
          : path(path), stream(path, std::ios::binary), n_bytes(std::filesystem::file_size(path))
      {
        little_endian             = number(0, 1) == 'I';
        const std::uint64_t order = number(0, 2), version = number(2, 2);
        if ((order != 0x4949 && order != 0x4d4d) || (version != 42 && version != 43))
          fail("this is not a TIFF file; give the file its right extension");
        big = version == 43;
      }

      [[noreturn]] void
      fail(const std::string &message) const
      {
        throw UserError(path, message);
      }

      void
      require_inside(const std::uint64_t place, const std::uint64_t length) const
      {
        if (length > n_bytes || place > n_bytes - length)
          fail(cut_off);
      }

      std::uint64_t
      number(const std::uint64_t place, const unsigned int width)
      {
        require_inside(place, width);
        unsigned char bytes[8];
        stream.seekg(place);
        stream.read(reinterpret_cast<char *>(bytes), width);
        std::uint64_t value = 0;
        for (unsigned int i = 0; i < width; ++i)
          value = value << 8 | bytes[little_endian ? width - 1 - i : i];
        return value;
      }

      std::uint64_t
      first_page()
      {
        return big ? number(8, 8) : number(4, 4);
      }

      /// Read the page whose directory is at `place`, and set `place` to the next one's, 0 after the last.
      Page
      read_page(std::uint64_t &place)
      {
        const unsigned int  count_width = big ? 8 : 2, entry_width = big ? 20 : 12;
        const std::uint64_t n_entries = number(place, count_width);
        place += count_width;
        if (n_entries > 0xffff)
          fail(cut_off);
        Page page;
        for (std::uint64_t i = 0; i < n_entries; ++i, place += entry_width)
          read_entry(place, page);
        place = number(place, offset_width());
        return page;
      }

    private:
      unsigned int
      offset_width() const
      {
        return big ? 8 : 4;
      }

      /// Add the values of the directory entry at `place` to `page` if they are unsigned whole numbers.
      void
      read_entry(const std::uint64_t place, Page &page)
      {
        const unsigned int  tag   = number(place, 2);
        const std::uint64_t type  = number(place + 2, 2);
        const unsigned int  width = type == 1 ? 1 : type == 3 ? 2 : type == 4 ? 4 : type == 16 ? 8 : 0;
        if (width == 0 || wanted.count(tag) == 0)
          return;
        const std::uint64_t count = number(place + 4, offset_width());
        if (count > n_bytes / width)
          fail(cut_off);
        std::uint64_t value = place + 4 + offset_width();
        if (count * width > offset_width())
          value = number(value, offset_width());
        for (std::uint64_t i = 0; i < count; ++i)
          page[tag].push_back(number(value + i * width, width));
      }

      const std::set<unsigned int> wanted
          = { subfile_type,      width,     height, bits_per_sample, photometric, strip_offsets, samples_per_pixel,
              strip_byte_counts, tile_width };
      std::string   path;
      std::ifstream stream;
      std::uint64_t n_bytes;
      bool          little_endian = true, big = false;
    };

    std::uint64_t
    value(const Page &page, const Tag tag, const std::uint64_t absent)
    {
      const auto entry = page.find(tag);
      return entry == page.end() || entry->second.empty() ? absent : entry->second[0];
    }

    void
    check_kind(const TiffFile &file, const Page &page)
    {
      if (page.count(tile_width))
        file.fail("TIFF pages stored in tiles cannot be read; save the stack with strips (ImageJ does) or as NRRD");
      const std::uint64_t samples = value(page, samples_per_pixel, 1), grey = value(page, photometric, 1);
      if (samples != 1 || grey > 1)
        file.fail("this TIFF has colours (" + std::to_string(samples) + " values a pixel, photometric "
                  + std::to_string(grey) + "), allowed is one grey value; save one channel as 8 or 16 bit grey");
      const std::uint64_t bits = value(page, bits_per_sample, 1);
      if (bits != 8 && bits != 16)
        file.fail("this TIFF has " + std::to_string(bits) + " bits a pixel, allowed are 8 and 16; convert it");
      if (value(page, subfile_type, 0) & 5)
        file.fail("this TIFF holds reduced copies or masks of its pages; save the plain pages only");
    }

    void
    check_strips(const TiffFile &file, const Page &page)
    {
      const auto offsets = page.find(strip_offsets), counts = page.find(strip_byte_counts);
      if (offsets == page.end() || counts == page.end() || offsets->second.size() != counts->second.size())
        file.fail(cut_off);
      for (std::size_t i = 0; i < offsets->second.size(); ++i)
        file.require_inside(offsets->second[i], counts->second[i]);
    }
  } // namespace

  unsigned int
  check_tiff(const std::string &path)
  {
    TiffFile                file(path);
    std::set<std::uint64_t> visited;
    std::uint64_t           place = file.first_page(), first_width = 0, first_height = 0;
    while (place != 0)
    {
      if (!visited.insert(place).second)
        file.fail(cut_off);
      const Page page = file.read_page(place);
      check_kind(file, page);
      check_strips(file, page);
      const std::uint64_t page_width = value(page, width, 0), page_height = value(page, height, 0);
      if (visited.size() == 1)
        first_width = page_width, first_height = page_height;
      if (page_width != first_width || page_height != first_height)
        file.fail("page " + std::to_string(visited.size()) + " has " + std::to_string(page_width) + " x "
                  + std::to_string(page_height) + " pixels, the first " + std::to_string(first_width) + " x "
                  + std::to_string(first_height) + "; all pages of a stack must have one size");
    }
    if (visited.empty())
      file.fail(cut_off);
    return visited.size();
  }
} // namespace Stroma::Image
