#pragma once

#include <deal.II/base/array_view.h>
#include <deal.II/base/mpi.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace Stroma::Output
{
  /**
   * A checkpoint: named arrays, distributed over the ranks, and named single values, in one HDF5 file. Each array is a
   * dataset with the ranks' blocks one after another, beside it "<name>.blocks" with the length and the CRC-32 of each
   * block; single values are scalar datasets below "attributes", each with its CRC-32 in "<name>.checksum". A '/' in a name makes a group.
   *
   * The data go to a temporary file that commit() renames, so the final name always holds a complete archive. Nothing
   * throws before commit(): after a failure on any rank all ranks skip what follows, and commit() removes the temporary
   * and throws OutputError with the reason on all ranks. Everything is collective, with the same names on all ranks.
   *
   * Rank 0 writes alone and the others send it their blocks, 64 MB at a time. Parallel HDF5 was tried first: when a
   * write fails on one rank (disk full) the others wait for ever inside MPI-IO. The HDF5 library is called directly:
   * deal.II 9.4's dealii::HDF5 checks results with Assert only, so a full disk would pass unnoticed in release mode.
   */
  class ArchiveWriter
  {
  public:
    ArchiveWriter(const std::string &path, MPI_Comm comm);
    /// Removes the temporary file unless commit() was called. Collective.
    ~ArchiveWriter();
    ArchiveWriter(const ArchiveWriter &)            = delete;
    ArchiveWriter &operator=(const ArchiveWriter &) = delete;

    /// This rank's block; its length may be 0 and differ from rank to rank.
    void write(const std::string &name, const dealii::ArrayView<const double> &block);
    void write(const std::string &name, const dealii::ArrayView<const std::uint64_t> &block);

    /// A single value; rank 0's counts.
    void attribute(const std::string &name, const std::string &value);
    void attribute(const std::string &name, double value);
    void attribute(const std::string &name, std::uint64_t value);

    /// Completes the file and gives it its final name.
    void commit();

  private:
    struct File;
    template <typename Number>
    void write_array(const std::string &name, const dealii::ArrayView<const Number> &block);
    void agree(const std::string &local_error);

    std::string           path, temporary;
    MPI_Comm              comm;
    std::unique_ptr<File> file;
    std::string           error; ///< the same on all ranks
  };

  /**
   * Reads what ArchiveWriter wrote, on any number of ranks. Everything is collective and throws UserError on all ranks
   * (file missing, not HDF5, truncated, not complete, name missing, block damaged).
   */
  class ArchiveReader
  {
  public:
    ArchiveReader(const std::string &path, MPI_Comm comm);
    ~ArchiveReader();

    /// Reads everything once: the name of the first array or single value whose checksum does not fit, or "".
    std::string damage() const;

    /// On as many ranks as wrote it: exactly this rank's block, checked against its CRC-32. Otherwise an even,
    /// contiguous share of the whole, in rows of @p width numbers.
    std::vector<double>        read_double(const std::string &name, unsigned int width = 1) const;
    std::vector<std::uint64_t> read_uint64(const std::string &name, unsigned int width = 1) const;

    std::string   attribute_string(const std::string &name) const;
    double        attribute_double(const std::string &name) const;
    std::uint64_t attribute_uint64(const std::string &name) const;

    bool has(const std::string &name) const; ///< whether there is an array of this name
    bool
    is_same_ranks() const
    {
      return same_ranks;
    } ///< written on as many ranks as read

  private:
    struct File;

    std::string           path;
    MPI_Comm              comm;
    std::unique_ptr<File> file;
    bool                  same_ranks = false;
  };
} // namespace Stroma::Output
