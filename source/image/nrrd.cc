#include "compressed.h"
#include "formats.h"
#include "itk_io.h"
#include "words.h"

#include <stroma/base/errors.h>

#include <NrrdIO.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

namespace Stroma::Image
{
  namespace
  {
    /// The fields "key: value" of a NRRD header, which ends at an empty line or with the file.
    struct Fields
    {
      std::map<std::string, std::string> value;
      std::size_t                        end = 0; ///< first byte after the header

      explicit Fields(const std::string &path)
      {
        std::ifstream file(path, std::ios::binary);
        std::string   line;
        while (std::getline(file, line) && value.size() < 1000)
          {
            end += line.size() + 1;
            while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
              line.pop_back();
            if (line.empty())
              break;
            if (const auto colon = line.find(": "); colon != std::string::npos && line[0] != '#')
              value[lower_case(line.substr(0, colon))] = line.substr(colon + 2);
          }
      }

      std::string
      text(const std::vector<std::string> &names) const
      {
        for (const auto &name : names)
          if (value.count(name) > 0)
            return value.at(name);
        return "";
      }
    };

    /// What NrrdIO takes without a word: sizes that are no whole numbers, more sizes than dimensions.
    void
    check_sizes(const std::string &path, const Fields &fields)
    {
      const auto sizes = words(fields.text({"sizes"}));
      for (const auto &size : sizes)
        if (!std::all_of(size.begin(), size.end(), [](const unsigned char c) { return std::isdigit(c); }))
          throw UserError(path,
                          "the header has 'sizes: " + readable(fields.text({"sizes"})) + "'; sizes are whole numbers");
      if (const auto n = to_number(fields.text({"dimension"})); n && *n != sizes.size())
        throw UserError(path, "the header has 'dimension: " + number(*n) + "' but 'sizes: " +
                                readable(fields.text({"sizes"})) + "'; it must have one size a dimension");
    }

    /// What NrrdIO does not look at: a gzip stream's end and checksum, a last number that was cut short.
    void
    check_end(const std::string &path, const Fields &fields)
    {
      const std::string data     = fields.text({"data file", "datafile"});
      const std::string encoding = lower_case(fields.text({"encoding"}));
      if (words(data).size() > 1 || data == "LIST")
        return; // several files
      const std::string file  = data.empty() ? path : (std::filesystem::path(path).parent_path() / data).string();
      const bool        plain = fields.text({"line skip", "lineskip"}).empty();
      const bool        gzip  = encoding == "gzip" || encoding == "gz";
      if (gzip && plain && !inflated(file_content(file, data.empty() ? fields.end : 0)))
        throw UserError(file,
                        "the image file is cut off or damaged: its compressed voxels are not whole; copy it again "
                        "from its source");
      if (encoding == "text" || encoding == "txt" || encoding == "ascii")
        {
          const std::string content = file_content(file);
          if (content.empty() || !std::isspace(static_cast<unsigned char>(content.back())))
            throw UserError(file,
                            "the text of the voxels has no line end, so that its last number may be cut off; copy it "
                            "again from its source, or end the last line");
        }
    }

    Sample
    sample_of_type(const std::string &path, const int type)
    {
      static const std::map<int, Sample> known = {{nrrdTypeChar, Sample::i8},   {nrrdTypeUChar, Sample::u8},
                                                  {nrrdTypeShort, Sample::i16}, {nrrdTypeUShort, Sample::u16},
                                                  {nrrdTypeInt, Sample::i32},   {nrrdTypeUInt, Sample::u32},
                                                  {nrrdTypeLLong, Sample::i64}, {nrrdTypeULLong, Sample::u64},
                                                  {nrrdTypeFloat, Sample::f32}, {nrrdTypeDouble, Sample::f64}};
      const auto                         found = known.find(type);
      if (found == known.end())
        throw UserError(path, "the image has values of type block, allowed are numbers of 8 to 64 bits; convert it");
      return found->second;
    }

    /// The last line of NrrdIO's report, which has the cause.
    std::string
    reason()
    {
      const std::unique_ptr<char, decltype(&std::free)> report(biffGetDone(NRRD), std::free);
      std::string                                       text = report ? report.get() : "";
      while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())))
        text.pop_back();
      text = text.substr(text.find_last_of('\n') + 1);
      if (const auto colon = text.find(": "); text.rfind("[nrrd] ", 0) == 0 && colon != std::string::npos)
        text = text.substr(colon + 2);
      return readable(text);
    }

    /// Take spacing, unit and direction of file axis `a` as those of stored axis `i`.
    void
    set_axis(const std::string &path, const Nrrd &nrrd, const unsigned int a, const unsigned int i, Stored &stored)
    {
      const NrrdAxisInfo &axis = nrrd.axis[a];
      stored.size[i]           = axis.size;
      stored.spacing[i]        = axis.spacing;
      stored.unit[i]           = axis.units ? axis.units : "";
      if (nrrd.spaceDim == 0)
        return;
      if (nrrd.spaceDim > 3)
        throw UserError(path, "the image lies in a space of " + std::to_string(nrrd.spaceDim) +
                                " dimensions; allowed are two and three");
      double square = 0;
      for (unsigned int d = 0; d < nrrd.spaceDim; ++d)
        square += axis.spaceDirection[d] * axis.spaceDirection[d];
      stored.spacing[i] = std::sqrt(square);
      unsigned int main = 0;
      for (unsigned int d = 0; d < 3; ++d)
        {
          stored.direction[i][d] = d < nrrd.spaceDim ? axis.spaceDirection[d] / stored.spacing[i] : 0;
          if (std::abs(stored.direction[i][d]) > std::abs(stored.direction[i][main]))
            main = d;
        }
      if (nrrd.spaceUnits[main] && *nrrd.spaceUnits[main])
        stored.unit[i] = nrrd.spaceUnits[main];
    }

    bool
    is_spatial(const Nrrd &nrrd, const unsigned int a)
    {
      if (nrrd.spaceDim > 0)
        return std::isfinite(nrrd.axis[a].spaceDirection[0]);
      const int kind = nrrd.axis[a].kind;
      return kind == nrrdKindUnknown || kind == nrrdKindDomain || kind == nrrdKindSpace;
    }

    /// Sort the file's axes into those of space and, last, that of frames. Returns the number of frames.
    std::size_t
    set_axes(const std::string &path, const Nrrd &nrrd, Stored &stored)
    {
      unsigned int n_axes   = 0;
      std::size_t  n_frames = 1;
      for (unsigned int a = 0; a < nrrd.dim; ++a)
        {
          const std::size_t size = nrrd.axis[a].size;
          if (is_spatial(nrrd, a) && n_axes < 3)
            set_axis(path, nrrd, a, n_axes++, stored);
          else if (size > 1 && a + 1 == nrrd.dim && n_axes >= 2)
            n_frames = size;
          else if (size > 1)
            throw UserError(path, "the image has " + std::to_string(size) + " components along axis " +
                                    std::to_string(a + 1) + ", allowed is one value a voxel; save one channel as grey");
        }
      if (n_axes < 2)
        throw UserError(path, "the image has " + std::string(n_axes == 1 ? "one axis" : "no axis") +
                                " of space; it must be two- or three-dimensional");
      stored.n_axes = n_axes;
      for (unsigned int d = 0; d < nrrd.spaceDim && d < 3; ++d)
        stored.origin[d] = std::isfinite(nrrd.spaceOrigin[d]) ? nrrd.spaceOrigin[d] : 0.;
      if (nrrd.space != nrrdSpaceUnknown)
        stored.space = airEnumStr(nrrdSpace, nrrd.space);
      return n_frames;
    }
  } // namespace

  Stored
  read_nrrd(const std::string &path, const Selection &selection)
  {
    const Quiet                                      quiet;
    const Fields                                     fields(path);
    const std::unique_ptr<Nrrd, decltype(&nrrdNuke)> nrrd(nrrdNew(), nrrdNuke);
    check_sizes(path, fields);
    if (nrrdLoad(nrrd.get(), path.c_str(), nullptr) != 0)
      throw UserError(path, "the image cannot be read: it is no NRRD, cut off or damaged (" + reason() + ")");
    check_end(path, fields);
    Stored            stored;
    const std::size_t n_frames = set_axes(path, *nrrd, stored);
    const std::size_t frame    = choose(path, "frame", n_frames, selection.frame);
    choose(path, "channel", 1, selection.channel);
    stored.sample             = sample_of_type(path, nrrd->type);
    const std::size_t n_bytes = checked_bytes(path,
                                              {double(stored.size[0]), double(stored.size[1]), double(stored.size[2])},
                                              stored.sample);
    stored.bytes.assign(static_cast<const char *>(nrrd->data) + frame * n_bytes, n_bytes);
    return stored;
  }
} // namespace Stroma::Image
