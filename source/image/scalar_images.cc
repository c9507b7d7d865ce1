#include "words.h"

#include <stroma/base/output_error.h>
#include <stroma/image/scalar_images.h>

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <tiffio.h>

namespace Stroma::Image
{
  namespace
  {
    std::string
    brief_number(const double x)
    {
      std::ostringstream text;
      text.precision(12);
      text << x;
      return text.str();
    }

    std::string
    three(const std::array<double, 3> &x, const std::string &between)
    {
      return brief_number(x[0]) + between + brief_number(x[1]) + between + brief_number(x[2]);
    }

    void
    check_stream(const std::ofstream &file, const std::string &path)
    {
      if (!file)
        throw OutputError(path, std::string("the image cannot be written (") + std::strerror(errno) + ")");
    }

    void
    put(std::ofstream &file, const std::vector<float> &slice)
    {
      file.write(reinterpret_cast<const char *>(slice.data()), slice.size() * sizeof(float));
    }

    class NrrdImages : public ScalarImages
    {
    public:
      NrrdImages(const std::string &stem, const std::string &number, const std::vector<std::string> &names,
                 const ScalarGrid &grid)
      {
        for (const auto &name : names)
          {
            paths.push_back(stem + "_" + name + "_" + number + ".nrrd");
            streams.emplace_back(paths.back(), std::ios::binary);
            streams.back() << header(name, grid);
            check_stream(streams.back(), paths.back());
          }
      }

      void
      add(const std::size_t i, const std::vector<float> &slice) override
      {
        put(streams[i], slice);
        check_stream(streams[i], paths[i]);
      }

      void
      close() override
      {
        for (std::size_t i = 0; i < streams.size(); ++i)
          {
            streams[i].close();
            check_stream(streams[i], paths[i]);
          }
      }

    private:
      static std::string
      header(const std::string &name, const ScalarGrid &grid)
      {
        std::ostringstream text;
        const auto        &s    = grid.spacing;
        const auto         unit = "\"" + unit_word(grid.frame.unit) + "\"";
        text << "NRRD0004\ntype: float\ndimension: 3\n"
             << (grid.frame.space.empty() ? "space dimension: 3\n" : "space: " + grid.frame.space + "\n")
             << "sizes: " << grid.size[0] << " " << grid.size[1] << " " << grid.size[2] << "\nspace directions: ("
             << brief_number(s[0]) << ",0,0) (0," << brief_number(s[1]) << ",0) (0,0," << brief_number(s[2])
             << ")\nspace units: " << unit << " " << unit << " " << unit
             << "\nkinds: domain domain domain\nspace origin: (" << three(grid.frame.first, ",")
             << ")\nendian: little\nencoding: raw\ncontent: " << name << "\n\n";
        return text.str();
      }

      std::vector<std::ofstream> streams;
    };

    /// An image of cells with all arrays appended raw.
    class VtiImages : public ScalarImages
    {
    public:
      VtiImages(const std::string &stem, const std::string &number, const std::vector<std::string> &names,
                const ScalarGrid &grid)
        : slice_bytes(std::uint64_t(grid.size[0]) * grid.size[1] * sizeof(float))
        , image_bytes(slice_bytes * grid.size[2])
        , n_slices(names.size(), 0)
      {
        paths.push_back(stem + "_" + number + ".vti");
        file.open(paths.front(), std::ios::binary);
        file << header(names, grid);
        first = file.tellp();
        for (std::size_t i = 0; i < names.size(); ++i)
          {
            file.seekp(first + i * (sizeof(image_bytes) + image_bytes));
            file.write(reinterpret_cast<const char *>(&image_bytes), sizeof(image_bytes));
          }
        check_stream(file, paths.front());
      }

      void
      add(const std::size_t i, const std::vector<float> &slice) override
      {
        file.seekp(first + i * (sizeof(image_bytes) + image_bytes) + sizeof(image_bytes) + slice_bytes * n_slices[i]++);
        put(file, slice);
        check_stream(file, paths.front());
      }

      void
      close() override
      {
        file.seekp(first + n_slices.size() * (sizeof(image_bytes) + image_bytes));
        file << "\n</AppendedData>\n</VTKFile>\n";
        file.close();
        check_stream(file, paths.front());
      }

    private:
      std::string
      header(const std::vector<std::string> &names, const ScalarGrid &grid) const
      {
        auto corner = grid.frame.first;
        for (unsigned int d = 0; d < 3; ++d)
          corner[d] -= grid.spacing[d] / 2;
        std::ostringstream extent, text;
        extent << "0 " << grid.size[0] << " 0 " << grid.size[1] << " 0 " << grid.size[2];
        text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
             << "header_type=\"UInt64\">\n<ImageData WholeExtent=\"" << extent.str() << "\" Origin=\""
             << three(corner, " ") << "\" Spacing=\"" << three(grid.spacing, " ") << "\">\n<Piece Extent=\""
             << extent.str() << "\">\n<CellData>\n";
        for (std::size_t i = 0; i < names.size(); ++i)
          text << "<DataArray type=\"Float32\" Name=\"" << names[i] << "\" format=\"appended\" offset=\""
               << i * (sizeof(image_bytes) + image_bytes) << "\"/>\n";
        text << "</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
        return text.str();
      }

      const std::uint64_t        slice_bytes, image_bytes;
      std::vector<std::uint64_t> n_slices;
      std::ofstream              file;
      std::uint64_t              first = 0;
    };

    class TiffImages : public ScalarImages
    {
    public:
      TiffImages(const std::string &stem, const std::string &number, const std::vector<std::string> &names,
                 const ScalarGrid &grid)
        : grid(grid)
        , n_slices(names.size(), 0)
      {
        const bool is_big = 4. * grid.size[0] * grid.size[1] * grid.size[2] > 3.9e9;
        for (const auto &name : names)
          {
            paths.push_back(stem + "_" + name + "_" + number + ".tif");
            tiffs.emplace_back(TIFFOpen(paths.back().c_str(), is_big ? "w8" : "w"), TIFFClose);
            if (!tiffs.back())
              fail(paths.size() - 1);
          }
      }

      void
      add(const std::size_t i, const std::vector<float> &slice) override
      {
        TIFF *const tiff = tiffs[i].get();
        set_fields(tiff, n_slices[i]++ == 0);
        for (unsigned int y = 0; y < grid.size[1]; ++y)
          if (TIFFWriteScanline(tiff, const_cast<float *>(&slice[std::size_t(y) * grid.size[0]]), y, 0) < 0)
            fail(i);
        if (TIFFWriteDirectory(tiff) == 0)
          fail(i);
      }

      void
      close() override
      {
        for (std::size_t i = 0; i < tiffs.size(); ++i)
          if (TIFFFlush(tiffs[i].get()) == 0)
            fail(i);
        tiffs.clear();
      }

    private:
      void
      set_fields(TIFF *const tiff, const bool is_first) const
      {
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, grid.size[0]);
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, grid.size[1]);
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, grid.size[1]);
        TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 1. / grid.spacing[0]);
        TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 1. / grid.spacing[1]);
        TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_NONE);
        const std::string n = std::to_string(grid.size[2]);
        if (is_first)
          TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION,
                       ("ImageJ=1.53\nimages=" + n + "\nslices=" + n + "\nunit=" + unit_word(grid.frame.unit) +
                        "\nspacing=" + brief_number(grid.spacing[2]) + "\n")
                         .c_str());
      }

      [[noreturn]] void
      fail(const std::size_t i) const
      {
        throw OutputError(paths[i], std::string("the image cannot be written (") + std::strerror(errno) + ")");
      }

      const ScalarGrid                                     grid;
      std::vector<std::unique_ptr<TIFF, void (*)(TIFF *)>> tiffs;
      std::vector<unsigned int>                            n_slices;
    };
  } // namespace

  std::unique_ptr<ScalarImages>
  ScalarImages::make(const ScalarFormat format, const std::string &stem, const std::string &number,
                     const std::vector<std::string> &names, const ScalarGrid &grid)
  {
    if (format == ScalarFormat::vti)
      return std::make_unique<VtiImages>(stem, number, names, grid);
    if (format == ScalarFormat::tiff)
      return std::make_unique<TiffImages>(stem, number, names, grid);
    return std::make_unique<NrrdImages>(stem, number, names, grid);
  }
} // namespace Stroma::Image
