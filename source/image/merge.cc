#include <stroma/image/merge.h>

#include "words.h"

#include <stroma/base/errors.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace Stroma::Image
{
  namespace
  {
    /// The value that occurs most often, the lowest of several, and whether there are several; sorts `values`.
    template <typename T>
    std::pair<T, bool>
    most_frequent(std::vector<T> &values)
    {
      std::sort(values.begin(), values.end());
      T    best       = values.front();
      long best_count = 0;
      bool is_tie     = false;
      for (auto run = values.begin(); run != values.end();)
        {
          const auto run_end = std::upper_bound(run, values.end(), *run);
          is_tie             = run_end - run == best_count || (is_tie && run_end - run < best_count);
          if (run_end - run > best_count)
            {
              best       = *run;
              best_count = run_end - run;
            }
          run = run_end;
        }
      return {best, is_tie};
    }

    /// Copy the block of `labels` that becomes voxel (x, y, z) into `values`.
    template <typename T>
    void
    gather_block(const Volume<T> &labels, const std::array<unsigned int, 3> &block,
                 const std::array<unsigned int, 3> &voxel, std::vector<T> &values)
    {
      values.clear();
      for (unsigned int z = 0; z < block[2]; ++z)
        for (unsigned int y = 0; y < block[1]; ++y)
          {
            const T *row = &labels.at(voxel[0] * block[0], voxel[1] * block[1] + y, voxel[2] * block[2] + z);
            values.insert(values.end(), row, row + block[0]);
          }
    }
  } // namespace

  template <typename T>
  MergedVolume<T>
  merge_labels(const Volume<T> &labels, const std::array<unsigned int, 3> &block)
  {
    MergedVolume<T> merged;
    merged.size       = labels.size;
    merged.voxel_size = labels.voxel_size;
    merged.origin     = labels.origin;
    for (unsigned int d = 0; d < 3; ++d)
      {
        if (block[d] == 0 || labels.size[d] % block[d] != 0)
          throw UserError("cannot merge blocks of " + std::to_string(block[d]) + " voxels along " + axis_names[d] +
                          ": the edge must divide the image's " + std::to_string(labels.size[d]) +
                          " voxels there; crop the image or change the block");
        merged.size[d] /= block[d];
        merged.voxel_size[d] *= block[d];
      }
    merged.data.resize(merged.n_voxels());
    std::vector<T> values;
    for (unsigned int z = 0; z < merged.size[2]; ++z)
      for (unsigned int y = 0; y < merged.size[1]; ++y)
        for (unsigned int x = 0; x < merged.size[0]; ++x)
          {
            gather_block(labels, block, {{x, y, z}}, values);
            const auto [value, is_tie] = most_frequent(values);
            merged.at(x, y, z)         = value;
            merged.n_ties += is_tie;
          }
    return merged;
  }

  template MergedVolume<std::uint8_t>  merge_labels(const Volume<std::uint8_t> &, const std::array<unsigned int, 3> &);
  template MergedVolume<std::uint16_t> merge_labels(const Volume<std::uint16_t> &, const std::array<unsigned int, 3> &);
} // namespace Stroma::Image
