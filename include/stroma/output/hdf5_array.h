#pragma once

#include <stroma/output/hdf5_handle.h>

#include <algorithm>
#include <cstdint>

namespace Stroma::Output
{
  /// The library's type of a number in memory and in Stroma's files.
  template <typename Number> hid_t hdf5_type();

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
    return { H5Screate_simple(1, &length, nullptr), H5Sclose };
  }

  /// Calls transfer(memory space, file space, offset) for [begin, begin + length) of a one-dimensional dataset in
  /// chunks of 512 MB, because MPI-IO counts bytes in 32 bits. False as soon as a call returns a negative number.
  template <typename Transfer>
  bool
  by_chunks(const hid_t set, const hsize_t begin, const hsize_t length, const Transfer &transfer)
  {
    constexpr hsize_t chunk = hsize_t(1) << 26;
    const Hdf5Handle  in_file(H5Dget_space(set), H5Sclose);
    for (hsize_t done = 0; done < length; done += chunk)
    {
      const hsize_t    count = std::min(chunk, length - done), start = begin + done;
      const Hdf5Handle in_memory = line_space(count);
      if (H5Sselect_hyperslab(in_file, H5S_SELECT_SET, &start, nullptr, &count, nullptr) < 0
          || transfer(in_memory, in_file, done) < 0)
        return false;
    }
    return true;
  }

  /// Writes [begin, begin + length) of a one-dimensional dataset from @p data; local to the rank.
  template <typename Number>
  bool
  write_range(const hid_t set, const Number *data, const hsize_t begin, const hsize_t length)
  {
    return by_chunks(set, begin, length,
                     [&](const hid_t memory, const hid_t in_file, const hsize_t offset)
                     { return H5Dwrite(set, hdf5_type<Number>(), memory, in_file, H5P_DEFAULT, data + offset); });
  }

  /// Reads [begin, begin + length) of a one-dimensional dataset into @p data; local to the rank.
  template <typename Number>
  bool
  read_range(const hid_t set, Number *data, const hsize_t begin, const hsize_t length)
  {
    return by_chunks(set, begin, length,
                     [&](const hid_t memory, const hid_t in_file, const hsize_t offset)
                     { return H5Dread(set, hdf5_type<Number>(), memory, in_file, H5P_DEFAULT, data + offset); });
  }
} // namespace Stroma::Output
