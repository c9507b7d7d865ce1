#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

/// An image of labels with voxels of 1 um, in a file that is gone with this object.
class LabelFile
{
public:
  /// @param label of the voxel (x, y), called row by row
  template <typename Label>
  LabelFile(const unsigned int nx, const unsigned int ny, const Label &label)
    : LabelFile(2, nx, ny, 1, [&](const unsigned int x, const unsigned int y, unsigned int) { return label(x, y); })
  {}
  /// In space.
  template <typename Label>
  LabelFile(const unsigned int nx, const unsigned int ny, const unsigned int nz, const Label &label)
    : LabelFile(3, nx, ny, nz, label)
  {}
  ~LabelFile()
  {
    std::error_code code;
    std::filesystem::remove(path, code);
  }
  LabelFile(const LabelFile &) = delete;

  const std::filesystem::path path;

private:
  template <typename Label>
  LabelFile(const unsigned int dim, const unsigned int nx, const unsigned int ny, const unsigned int nz,
            const Label &label)
    : path(std::filesystem::temp_directory_path() /
           ("stroma_voxels_" + std::to_string(getpid()) + "_" + std::to_string(++count()) + ".mha"))
  {
    std::ofstream file(path, std::ios::binary);
    file << "ObjectType = Image\nNDims = " << dim << "\nDimSize = " << nx << " " << ny
         << (dim == 3 ? " " + std::to_string(nz) : "") << "\nElementType = MET_UCHAR\nElementSpacing = 1 1"
         << (dim == 3 ? " 1" : "") << "\nDistanceUnits = um\nElementDataFile = LOCAL\n";
    for (unsigned int z = 0; z < nz; ++z)
      for (unsigned int y = 0; y < ny; ++y)
        for (unsigned int x = 0; x < nx; ++x)
          file.put(static_cast<char>(label(x, y, z)));
  }

  static unsigned int &
  count()
  {
    static unsigned int number = 0;
    return number;
  }
};
