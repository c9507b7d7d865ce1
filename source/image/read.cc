#include <stroma/image/read.h>

#include "formats.h"
#include "orientation.h"
#include "values.h"
#include "words.h"

#include <stroma/base/errors.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <new>

namespace Stroma::Image
{
  namespace
  {
    struct Format
    {
      const char *extension;
      Stored (*read)(const std::string &, const Selection &);
      bool        has_spacing; ///< or its spacing cannot be trusted: dots per inch, often a default
      const char *usual_unit;  ///< by convention where the header names none, if that is not the micrometre
    };

    const Format &
    format_of(const std::string &path)
    {
      static const Format formats[] = {{".tif", read_tiff, false, ""},       {".tiff", read_tiff, false, ""},
                                       {".nrrd", read_nrrd, true, ""},       {".nhdr", read_nrrd, true, ""},
                                       {".nii", read_nifti, true, ""},       {".nii.gz", read_nifti, true, ""},
                                       {".mha", read_metaimage, true, "mm"}, {".mhd", read_metaimage, true, "mm"}};
      const std::string   name      = lower_case(path);
      std::string         known;
      for (const Format &format : formats)
        {
          const std::string end = format.extension;
          if (name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0)
            return format;
          known += (known.empty() ? "" : " ") + end;
        }
      throw UserError(path, "unknown image format; known extensions are " + known);
    }

    void
    check_file(const std::string &path)
    {
      if (!std::filesystem::exists(path))
        throw UserError(path, "there is no such image file");
      if (!std::filesystem::is_regular_file(path) || !std::ifstream(path))
        throw UserError(path, "this is no readable file; give the path of an image");
    }

    /// Length of the unit of stored axis `i` [m], and a word on where it is from.
    double
    unit_of(const std::string &path, const Format &format, const Stored &stored, const unsigned int i,
            const std::optional<double> &spacing_unit, std::string &source)
    {
      const std::string &word = stored.unit[i];
      const auto         unit = metres(word);
      if (word.empty())
        {
          if (!spacing_unit && *format.usual_unit != '\0')
            throw UserError(path, std::string("the image names no unit of length, and by convention this format has ") +
                                    format.usual_unit +
                                    ", but many programs write um; say which by the entry 'Spacing unit'");
          source = spacing_unit ? "unit from 'Spacing unit'" : "the image names no unit: taken as um";
          return spacing_unit.value_or(1e-6);
        }
      if (!unit)
        throw UserError(path, "the image gives its spacing in '" + readable(word) +
                                "', which is no unit of length known here; give the entry \"Voxel size\"");
      if (spacing_unit && std::abs(*spacing_unit / *unit - 1) > 1e-9)
        throw UserError(path, "the image gives its spacing in " + word + ", but 'Spacing unit' is " +
                                unit_word(*spacing_unit) + "; leave that entry out, or give the entry \"Voxel size\"");
      source = "unit from the image: " + word;
      return *unit;
    }

    /// Edges of a voxel along the stored axes by the file's spacing [m].
    std::array<double, 3>
    stored_edges(const std::string &path, const Format &format, const Stored &stored, const ReadOptions &options,
                 std::string &source)
    {
      if (!format.has_spacing)
        throw UserError(path, "the spacing in a TIFF file cannot be trusted; give the entry \"Voxel size\"");
      if (!stored.spacing_fault.empty())
        throw UserError(path, stored.spacing_fault + "; give the entry \"Voxel size\"");
      std::array<double, 3> edges;
      const unsigned int    n_needed = options.plane ? std::min(stored.n_axes, 2u) : 3;
      for (unsigned int i = 0; i < 3; ++i)
        {
          const bool given = i < stored.n_axes && !std::isnan(stored.spacing[i]);
          if (!given && (i < n_needed || stored.size[i] > 1))
            throw UserError(path,
                            i < stored.n_axes ?
                              "the image does not say how far its voxels are apart; give the entry \"Voxel size\"" :
                              "the image has two dimensions and no edge of a voxel along the third; give the "
                              "entry \"Voxel size\"");
          edges[i] = given ? stored.spacing[i] * unit_of(path, format, stored, i, options.spacing_unit, source) :
                             edges[0];
          if (!(edges[i] > 0) || !std::isfinite(edges[i]))
            throw UserError(path, "the image has voxels of " + number(edges[i]) + " m along its stored axis " +
                                    std::to_string(i + 1) + "; give the entry \"Voxel size\"");
        }
      return edges;
    }

    /// The same along x, y, z.
    std::array<double, 3>
    edges_by_header(const std::string &path, const Format &format, const Stored &stored, const Orientation &orientation,
                    const ReadOptions &options, std::string &source)
    {
      const auto            edges = stored_edges(path, format, stored, options, source);
      std::array<double, 3> along;
      for (unsigned int i = 0; i < 3; ++i)
        along[orientation.axis[i]] = edges[i];
      return along;
    }

    /// Voxel edges by the header, where they are other ones than those given; else nothing.
    std::string
    said_by_header(const std::string &path, const Format &format, const Stored &stored, const Orientation &orientation,
                   const ReadOptions &options)
    {
      const auto           &given = *options.voxel_size;
      std::array<double, 3> said;
      try
        {
          std::string source;
          said = edges_by_header(path, format, stored, orientation, options, source);
        }
      catch (const UserError &) // it does not say, or not clearly
        {
          return "";
        }
      if (std::equal(said.begin(), said.end(), given.begin(),
                     [](const double a, const double b) { return std::abs(a - b) <= 1e-4 * b; }))
        return "";
      return ", NOT as the image has it: " + number(said[0] * 1e6) + " x " + number(said[1] * 1e6) + " x " +
             number(said[2] * 1e6) + " um";
    }

    Orientation
    orientation_for(const std::string &path, const Stored &stored, const bool stored_axes)
    {
      if (!stored.direction_fault.empty() && !stored_axes)
        throw UserError(path, stored.direction_fault +
                                "; correct it, or set 'Axes = stored' to take the stored axes for x, y, z");
      if (!stored_axes)
        return orientation_of(path, stored);
      if (stored.direction_fault.empty())
        check_square(path, stored);
      return {};
    }

    /// Where the header puts the voxels, once they are in the order of x, y, z.
    Frame
    frame_of(const std::string &path, const Format &format, const Stored &stored, const Orientation &orientation,
             const ReadOptions &options)
    {
      Frame frame;
      if (options.voxel_size || options.stored_axes)
        return frame;
      std::string source;
      frame.unit  = unit_of(path, format, stored, 0, options.spacing_unit, source);
      frame.first = stored.origin;
      frame.space = stored.space;
      for (unsigned int i = 0; i < stored.n_axes; ++i)
        if (orientation.reversed[i])
          frame.first[orientation.axis[i]] -= (stored.size[i] - 1.) * stored.spacing[i];
      return frame;
    }

    template <typename T>
    ReadVolume<T>
    read_whole(const std::string &path, const ReadOptions &options)
    {
      const Format &format      = format_of(path);
      Stored        stored      = format.read(path, {options.channel, options.frame});
      const auto    orientation = orientation_for(path, stored, options.stored_axes);
      ReadVolume<T> volume;
      volume.remarks = stored.remarks;
      if (options.voxel_size)
        {
          volume.voxel_size = *options.voxel_size;
          volume.remarks.insert(volume.remarks.begin(),
                                "voxel size as given" + said_by_header(path, format, stored, orientation, options));
        }
      else
        {
          std::string source;
          volume.voxel_size = edges_by_header(path, format, stored, orientation, options, source);
          volume.remarks.insert(volume.remarks.begin(), source);
        }
      for (unsigned int d = 0; d < 3; ++d)
        {
          if (!(volume.voxel_size[d] > 0) || !std::isfinite(volume.voxel_size[d]))
            throw UserError(path, "voxel size " + number(volume.voxel_size[d]) + " m along " + axis_names[d] +
                                    " is not positive; give the entry \"Voxel size\"");
          volume.size[d] = static_cast<unsigned int>(stored.size[d]);
        }
      volume.type  = in_words(stored.sample);
      volume.frame = frame_of(path, format, stored, orientation, options);
      volume.data  = values_of<T>(path, stored);
      if (!orientation.is_plain())
        {
          stored.bytes.clear();
          stored.bytes.shrink_to_fit();
          volume.data = in_order(volume.data, volume.size, orientation);
          volume.remarks.push_back("stored axes lie along " + orientation.text() + " (header)");
        }
      return volume;
    }
  } // namespace

  template <typename T>
  ReadVolume<T>
  read(const std::string &path, const ReadOptions &options)
  {
    try
      {
        check_file(path);
        return read_whole<T>(path, options);
      }
    catch (const UserError &)
      {
        throw;
      }
    catch (const std::bad_alloc &)
      {
        throw UserError(path, "the image is too large for the memory; crop or merge it with another program");
      }
    catch (const std::filesystem::filesystem_error &)
      {
        throw;
      }
    catch (const std::exception &error)
      {
        throw UserError(path, "the image cannot be read: " + std::string(error.what()));
      }
  }

  template ReadVolume<std::uint16_t> read(const std::string &, const ReadOptions &);
  template ReadVolume<float>         read(const std::string &, const ReadOptions &);
} // namespace Stroma::Image
