#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

/// A plane image of labels with voxels of 1 um, in a file that is gone with this object.
class LabelFile
{
public:
  /// @param label of the voxel (x, y), called row by row
  template <typename Label>
  LabelFile(const unsigned int nx, const unsigned int ny, const Label &label)
    : path(std::filesystem::temp_directory_path() /
           ("stroma_voxels_" + std::to_string(getpid()) + "_" + std::to_string(++count()) + ".mha"))
  {
    std::ofstream file(path, std::ios::binary);
    file << "ObjectType = Image\nNDims = 2\nDimSize = " << nx << " " << ny
         << "\nElementType = MET_UCHAR\nElementSpacing = 1 1\nDistanceUnits = um\nElementDataFile = LOCAL\n";
    for (unsigned int y = 0; y < ny; ++y)
      for (unsigned int x = 0; x < nx; ++x)
        file.put(static_cast<char>(label(x, y)));
  }
  ~LabelFile()
  {
    std::error_code code;
    std::filesystem::remove(path, code);
  }
  LabelFile(const LabelFile &) = delete;

  const std::filesystem::path path;

private:
  static unsigned int &
  count()
  {
    static unsigned int number = 0;
    return number;
  }
};
