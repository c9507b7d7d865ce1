#pragma once

#include <stroma/base/parameters.h>
#include <stroma/image/phantom.h>
#include <stroma/image/read.h>
#include <stroma/image/segment.h>

#include <optional>
#include <string>
#include <vector>

namespace Stroma
{
  /// The entries of a body that say how an image becomes material.
  struct ImageSettings
  {
    std::string               file;
    Image::ReadOptions        reading;
    std::array<double, 3>     corner{{0, 0, 0}};
    std::vector<unsigned int> crop_first, crop_size;
    bool                      threshold = false; ///< values are grey values, not labels
    Image::SegmentSettings    segment;           ///< of grey values
    std::vector<unsigned int> merge = {1, 1, 1};
    std::vector<std::string>  materials; ///< "label: material" each
    Image::PhantomSettings    phantom;
    std::string               where_file, where_threshold, where_materials, where_crop, where_merge,
      where_pieces; ///< for messages

    void add(Parameters &p);

  private:
    void add_spacing(Parameters &p);
    void add_threshold(Parameters &p);
    void add_smoothing(Parameters &p);
    void add_cleaning(Parameters &p);
    void add_phantom(Parameters &p);
  };
} // namespace Stroma
