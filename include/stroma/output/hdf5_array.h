#pragma once

#include <stroma/output/hdf5_handle.h>

#include <cstdint>

namespace Stroma::Output
{
  /// The library's type of a number in memory and in Stroma's files.
  template <typename Number>
  hid_t hdf5_type();

  template <>
  inline hid_t
  hdf5_type<double>()
  {
    return H5T_NATIVE_DOUBLE;
  }

  template <>
  inline hid_t
  hdf5_type<std::uint64_t>()
  {
    return H5T_NATIVE_UINT64;
  }

  /// The shape of a one-dimensional array.
  inline Hdf5Handle
  line_space(const hsize_t length)
  {
    return {H5Screate_simple(1, &length, nullptr), H5Sclose};
  }

  /// Calls transfer(memory space, file space) for the elements [begin, begin + length) of a one-dimensional dataset.
  /// False if the library refuses; nothing is called for length 0.
  template <typename Transfer>
  bool
  on_range(const hid_t set, const hsize_t begin, const hsize_t length, const Transfer &transfer)
  {
    if (length == 0)
      return true;
    const Hdf5Handle in_file(H5Dget_space(set), H5Sclose), in_memory = line_space(length);
    return H5Sselect_hyperslab(in_file, H5S_SELECT_SET, &begin, nullptr, &length, nullptr) >= 0 &&
           transfer(in_memory, in_file) >= 0;
  }

  /// Writes [begin, begin + length) of a one-dimensional dataset from @p data; local to the rank.
  template <typename Number>
  bool
  write_range(const hid_t set, const Number *data, const hsize_t begin, const hsize_t length)
  {
    return on_range(set, begin, length, [&](const hid_t memory, const hid_t in_file) {
      return H5Dwrite(set, hdf5_type<Number>(), memory, in_file, H5P_DEFAULT, data);
    });
  }

  /// Reads [begin, begin + length) of a one-dimensional dataset into @p data; local to the rank.
  template <typename Number>
  bool
  read_range(const hid_t set, Number *data, const hsize_t begin, const hsize_t length)
  {
    return on_range(set, begin, length, [&](const hid_t memory, const hid_t in_file) {
      return H5Dread(set, hdf5_type<Number>(), memory, in_file, H5P_DEFAULT, data);
    });
  }
} // namespace Stroma::Output
