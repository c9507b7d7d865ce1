#include "tiff_pages.h"

#include "words.h"

#include <stroma/base/counted.h>
#include <stroma/base/errors.h>

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/xml_parser.hpp>

#include <filesystem>
#include <numeric>
#include <set>

namespace Stroma::Image
{
  namespace
  {
    namespace pt = boost::property_tree;

    [[noreturn]] void
    fail_count(const std::string &path, const std::string &who, const std::string &what, const std::size_t n_pages)
    {
      throw UserError(path, "the TIFF has " + counted(n_pages, "page") + ", but its " + who +
                              " description speaks of " + what +
                              "; the file is cut off or was changed by another program; save the stack anew");
    }

    /// A file whose pages are all slices of one image.
    TiffPages
    slices_only(const std::size_t n_pages)
    {
      TiffPages pages;
      pages.n_slices = n_pages;
      pages.page.resize(n_pages);
      std::iota(pages.page.begin(), pages.page.end(), 0);
      return pages;
    }

    /// The number after "name=" at the begin of a line; 1 if there is none.
    std::size_t
    imagej_count(const std::string &description, const std::string &name)
    {
      const auto place = ("\n" + description).find("\n" + name + "=");
      const long count = place == std::string::npos ? 1 : std::atol(description.c_str() + place + name.size() + 1);
      return count > 0 ? static_cast<std::size_t>(count) : 0;
    }

    /// ImageJ's planes: channels fastest, then slices, then frames.
    TiffPages
    imagej_pages(const std::string &path, const std::string &description, const std::size_t n_pages)
    {
      TiffPages         pages;
      const std::size_t n_images = imagej_count(description, "images");
      pages.n_channels           = imagej_count(description, "channels");
      pages.n_frames             = imagej_count(description, "frames");
      pages.n_slices             = imagej_count(description, "slices");
      if (pages.n_channels * pages.n_frames * pages.n_slices == 1)
        pages.n_slices = n_images; // a plain stack may name its images only
      const std::string what = counted(n_images, "image") + ", " + counted(pages.n_channels, "channel") + ", " +
                               counted(pages.n_slices, "slice") + " and " + counted(pages.n_frames, "frame");
      if (n_images == 0 || pages.n_channels * pages.n_frames * pages.n_slices != n_images ||
          (n_pages != n_images && n_pages != 1))
        fail_count(path, "ImageJ", what, n_pages);
      pages.one_directory = n_pages == 1 && n_images > 1;
      for (std::size_t frame = 0; frame < pages.n_frames; ++frame)
        for (std::size_t channel = 0; channel < pages.n_channels; ++channel)
          for (std::size_t slice = 0; slice < pages.n_slices; ++slice)
            pages.page.push_back((frame * pages.n_slices + slice) * pages.n_channels + channel);
      return pages;
    }

    /// tifffile's shape: if pages have more than one dimension, nobody says which are slices.
    TiffPages
    tifffile_pages(const std::string &path, const std::string &description, const std::size_t n_pages)
    {
      pt::ptree          tree;
      std::istringstream stream(description);
      pt::read_json(stream, tree);
      std::vector<std::size_t> shape;
      std::string              text;
      for (const auto &entry : tree.get_child("shape"))
        {
          shape.push_back(entry.second.get_value<std::size_t>());
          text += (text.empty() ? "" : " x ") + std::to_string(shape.back());
        }
      std::size_t n_planes = 1, n_stacks = 0;
      for (std::size_t i = 0; i + 2 < shape.size(); ++i)
        {
          n_planes *= shape[i];
          n_stacks += shape[i] > 1 ? 1 : 0;
        }
      if (n_planes != n_pages && n_pages != 1)
        fail_count(path, "tifffile", "a shape of " + text, n_pages);
      if (n_stacks > 1)
        throw UserError(path, "the TIFF's pages are an array of " + text +
                                ", which may be slices, channels or frames; save one stack of slices");
      TiffPages pages     = slices_only(n_planes);
      pages.one_directory = n_pages == 1 && n_planes > 1;
      return pages;
    }

    /// Reads the planes of an OME description.
    class Ome
    {
    public:
      Ome(const std::string &path, const std::string &description, const std::size_t n_pages)
        : path(path)
        , n_pages(n_pages)
      {
        std::istringstream stream(description);
        pt::ptree          tree;
        pt::read_xml(stream, tree);
        unsigned int n_images = 0;
        for (const auto &[name, child] : root(tree))
          if (local(name) == "Image")
            for (const auto &[inner, content] : child)
              if (local(inner) == "Pixels" && ++n_images == 1)
                pixels = content;
        if (n_images != 1)
          throw UserError(path, "the OME-TIFF holds " + counted(n_images, "image") +
                                  ", allowed is one; save one of them by itself");
        order = pixels.get<std::string>("<xmlattr>.DimensionOrder");
      }

      TiffPages
      read()
      {
        pages.n_slices         = pixels.get<std::size_t>("<xmlattr>.SizeZ");
        pages.n_channels       = pixels.get<std::size_t>("<xmlattr>.SizeC");
        pages.n_frames         = pixels.get<std::size_t>("<xmlattr>.SizeT");
        const std::string what = counted(pages.n_slices, "slice") + ", " + counted(pages.n_channels, "channel") +
                                 " and " + counted(pages.n_frames, "frame");
        const std::size_t n_planes = pages.n_slices * pages.n_channels * pages.n_frames;
        if (n_planes == 0 || n_planes > 100000000)
          fail_count(path, "OME", what, n_pages);
        pages.page.assign(n_planes, absent);
        bool any = false;
        for (const auto &[name, block] : pixels)
          if (local(name) == "TiffData")
            {
              any = true;
              if (is_here(block))
                add(block);
            }
        if (!any)
          add(pt::ptree());
        const std::size_t here = n_planes -
                                 static_cast<std::size_t>(std::count(pages.page.begin(), pages.page.end(), absent));
        if (here != n_planes || n_planes != n_pages)
          fail_count(path, "OME", what + ", of which this file has " + counted(here, "plane"), n_pages);
        return pages;
      }

    private:
      static std::string
      local(const std::string &name)
      {
        return name.substr(name.find(':') == std::string::npos ? 0 : name.find(':') + 1);
      }

      const pt::ptree &
      root(const pt::ptree &tree) const
      {
        for (const auto &[name, child] : tree)
          if (local(name) == "OME")
            return child;
        throw UserError(path, "the TIFF's description is XML, but not OME's; save the stack anew");
      }

      /// Whether a block of planes is in this file; several files say so by their names.
      bool
      is_here(const pt::ptree &block) const
      {
        std::set<std::string> files;
        for (const auto &[name, other] : pixels)
          if (local(name) == "TiffData")
            files.insert(file_of(other));
        return files.size() <= 1 || file_of(block) == std::filesystem::path(path).filename().string();
      }

      static std::string
      file_of(const pt::ptree &block)
      {
        for (const auto &[name, child] : block)
          if (local(name) == "UUID")
            return child.get<std::string>("<xmlattr>.FileName", "");
        return "";
      }

      /// Number of the plane in the order of dimensions, and back to the place in `pages.page`.
      std::size_t
      place_of(std::size_t plane) const
      {
        std::size_t z = 0, c = 0, t = 0;
        for (const char letter : order.substr(2))
          {
            const std::size_t n = letter == 'Z' ? pages.n_slices : letter == 'C' ? pages.n_channels : pages.n_frames;
            (letter == 'Z' ? z : letter == 'C' ? c : t) = plane % n;
            plane /= n;
          }
        return (t * pages.n_channels + c) * pages.n_slices + z;
      }

      void
      add(const pt::ptree &block)
      {
        const auto        given = block.get_optional<std::size_t>("<xmlattr>.IFD");
        const std::size_t ifd   = given.get_value_or(0);
        std::size_t       first = 0, factor = 1;
        for (const char letter : order.substr(2))
          {
            first += factor * block.get<std::size_t>(std::string("<xmlattr>.First") + letter, 0);
            factor *= letter == 'Z' ? pages.n_slices : letter == 'C' ? pages.n_channels : pages.n_frames;
          }
        const std::size_t n = block.get<std::size_t>("<xmlattr>.PlaneCount", given ? 1 : n_pages);
        for (std::size_t i = 0; i < n && first + i < pages.page.size() && ifd + i < n_pages; ++i)
          pages.page[place_of(first + i)] = ifd + i;
      }

      static constexpr std::size_t absent = std::numeric_limits<std::size_t>::max();
      const std::string           &path;
      const std::size_t            n_pages;
      pt::ptree                    pixels;
      std::string                  order;
      TiffPages                    pages;
    };
  } // namespace

  std::vector<std::size_t>
  TiffPages::slices(const std::size_t channel, const std::size_t frame) const
  {
    const auto first = page.begin() + static_cast<std::ptrdiff_t>((frame * n_channels + channel) * n_slices);
    return {first, first + static_cast<std::ptrdiff_t>(n_slices)};
  }

  TiffPages
  tiff_pages(const std::string &path, const std::string &description, const std::size_t n_pages)
  {
    const bool is_ome = description.find("<OME") != std::string::npos || description.find(":OME") != std::string::npos;
    try
      {
        if (description.rfind("ImageJ=", 0) == 0)
          return imagej_pages(path, description, n_pages);
        if (is_ome)
          return Ome(path, description, n_pages).read();
        if (description.rfind("{\"shape\":", 0) == 0)
          return tifffile_pages(path, description, n_pages);
      }
    catch (const pt::ptree_error &error)
      {
        throw UserError(path, std::string("the TIFF's description of its pages cannot be read (") +
                                (is_ome ? "OME XML" : "JSON") + "); save the stack anew");
      }
    return slices_only(n_pages);
  }
} // namespace Stroma::Image
