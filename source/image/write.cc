#include <stroma/image/write.h>

#include "itk_io.h"

#include <stroma/base/errors.h>
#include <stroma/image/read.h>

#include <itkImageFileWriter.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace Stroma::Image
{
  namespace
  {
    namespace fs = std::filesystem;

    /// Say in the header of a NRRD or MetaImage what ITK's writers cannot: that the spacing is in micrometres, and in which space.
    void
    complete_header(const fs::path &path, const std::string &space)
    {
      std::ifstream input(path, std::ios::binary);
      std::string   content{std::istreambuf_iterator<char>(input), {}};
      const bool    is_nrrd = path.extension() == ".nrrd";
      if (const auto line = content.find("\nspace: ") + 1; is_nrrd && !space.empty() && line > 0)
        content.replace(line, content.find('\n', line) - line, "space: " + space);
      const auto    place = is_nrrd ? content.find("\n\n") + 1 : content.find("ElementSpacing");
      std::ofstream output(path, std::ios::binary);
      output << content.substr(0, place) << (is_nrrd ? "space units: \"um\" \"um\" \"um\"\n" : "DistanceUnits = um\n")
             << content.substr(place);
    }

    template <typename T>
    void
    write_file(const fs::path &path, const Volume<T> &volume, const std::string &space)
    {
      const Quiet quiet;
      auto        writer = itk::ImageFileWriter<itk::Image<T, 3>>::New();
      writer->SetImageIO(writer_of(path));
      writer->SetFileName(path);
      writer->SetUseCompression(path.extension() == ".nrrd" || path.extension() == ".mha");
      writer->SetInput(itk_view(volume));
      writer->Update();
      if (path.extension() == ".nrrd" || path.extension() == ".mha")
        complete_header(path, space);
    }

    /// True if the file was written and holds the volume's values.
    template <typename T>
    bool
    written_well(const fs::path &path, const Volume<T> &volume, const std::string &space)
    {
      try
        {
          write_file(path, volume, space);
          ReadOptions options;
          options.voxel_size  = volume.voxel_size;
          options.stored_axes = true;
          const auto copy     = read(path, options);
          return copy.size == volume.size && std::equal(copy.data.begin(), copy.data.end(), volume.data.begin());
        }
      catch (const std::exception &)
        {
          return false;
        }
    }
  } // namespace

  void
  check_target(const std::string &name, const bool overwrite)
  {
    const fs::path    path(name);
    const std::string extension = path.extension();
    std::error_code   code;
    if (extension != ".nrrd" && extension != ".mha" && extension != ".tif" && extension != ".tiff")
      throw UserError(path, "images are written as .nrrd, .mha, .tif or .tiff; change the extension");
    if (!overwrite && fs::exists(path, code))
      throw UserError(path, "the file exists and is not overwritten; remove it, give another name, or --overwrite it");
    if (path.has_parent_path() && !fs::is_directory(path.parent_path(), code))
      throw UserError(path, "the folder " + path.parent_path().string() + " does not exist; create it first");
  }

  template <typename T>
  void
  write(const std::string &path, const Volume<T> &volume, const bool overwrite, const std::string &space)
  {
    const fs::path target(path);
    check_target(path, overwrite);
    const fs::path  partial = fs::path(target).replace_filename("." + target.stem().string() + ".partial" +
                                                                target.extension().string());
    std::error_code error;
    const bool      well = written_well(partial, volume, space);
    if (well)
      fs::rename(partial, target, error);
    if (!well || error)
      {
        fs::remove(partial, error);
        throw UserError(path, "the image cannot be written there; check that the disk has room and allows writing");
      }
  }

  template void write(const std::string &, const Volume<std::uint8_t> &, bool, const std::string &);
  template void write(const std::string &, const Volume<std::uint16_t> &, bool, const std::string &);
} // namespace Stroma::Image
