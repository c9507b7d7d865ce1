#include <stroma/base/output_error.h>
#include <stroma/output/archive.h>
#include <stroma/output/archive_layout.h>
#include <stroma/output/collective.h>
#include <stroma/output/hdf5_array.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace Stroma::Output
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;
    namespace fs  = std::filesystem;

    constexpr std::size_t message = std::size_t(1) << 23; // numbers sent at a time
    constexpr int         tag     = 4711;

    /// A contiguous dataset without fill values; missing groups of its name are made.
    Hdf5Handle
    create_set(const hid_t file, const std::string &name, const hid_t type, const hid_t space)
    {
      const Hdf5Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose), create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      H5Pset_create_intermediate_group(link, 1);
      H5Pset_fill_time(create, H5D_FILL_TIME_NEVER);
      return {H5Dcreate2(file, name.c_str(), type, space, link, create, H5P_DEFAULT), H5Dclose};
    }

    /// Waits until the disk has the file.
    void
    synchronise(const std::string &path)
    {
      const int  file = open(path.c_str(), O_RDONLY);
      const bool good = file >= 0 && fsync(file) == 0;
      if (file >= 0)
        close(file);
      if (!good)
        throw OutputError("the disk did not take the data");
    }

    std::string
    megabytes(const std::uint64_t bytes)
    {
      char text[32];
      std::snprintf(text, sizeof(text), "%.3f MB", 1e-6 * static_cast<double>(bytes));
      return text;
    }
  } // namespace

  /// Rank 0 owns the file and the others send it their blocks. Functions are collective and return the reason of a
  /// failure on rank 0, or "".
  struct ArchiveWriter::File
  {
    std::string path;
    MPI_Comm    comm;
    Hdf5Handle  handle; // rank 0 only

    bool
    is_owner() const
    {
      return MPI::this_mpi_process(comm) == 0;
    }

    std::string
    create()
    {
      if (!is_owner())
        return "";
      const std::string reason = create_with_space(handle, path, 0);
      return reason.empty() ? "" : "it cannot be created: " + reason;
    }

    /// Makes sure that @p bytes (of all ranks) can be written. Rank 0 only.
    std::string
    reserve(const std::uint64_t bytes)
    {
      std::error_code code;
      const auto      available = fs::space(path, code).available;
      if (!code && bytes > available)
        return "no space left on the disk: " + megabytes(bytes) + " more are needed, " + megabytes(available) +
               " are free";
      return reserve_space(handle, bytes);
    }

    template <typename Number>
    std::string
    write_array(const std::string &name, const dealii::ArrayView<const Number> &block)
    {
      const std::uint64_t checksum = block_checksum(block.data(), block.size() * sizeof(Number));
      const auto          records  = MPI::gather(comm, std::vector<std::uint64_t>{block.size(), checksum});
      if (is_owner())
        return receive_blocks(name, block, records);
      for (std::size_t done = 0; done < block.size(); done += message)
        MPI_Send(block.data() + done, std::min(message, block.size() - done) * sizeof(Number), MPI_BYTE, 0, tag, comm);
      return "";
    }

    template <typename Number>
    std::string
    receive_blocks(const std::string &name, const dealii::ArrayView<const Number> &own,
                   const std::vector<std::vector<std::uint64_t>> &records)
    {
      std::vector<std::uint64_t> flat; // length and checksum of each rank
      hsize_t                    total = 0;
      for (const auto &record : records)
        {
          flat.insert(flat.end(), record.begin(), record.end());
          total += record[0];
        }
      const Hdf5Errors errors;
      Hdf5Handle       array  = create_set(handle, name, hdf5_type<Number>(), line_space(total));
      Hdf5Handle       blocks = create_set(handle, blocks_of(name), H5T_NATIVE_UINT64, line_space(flat.size()));

      bool good = array && blocks && write_range(blocks, flat.data(), 0, flat.size()) &&
                  write_range(array, own.data(), 0, own.size());
      std::vector<Number> buffer;
      hsize_t             begin = own.size();
      for (unsigned int rank = 1; rank < records.size(); ++rank)
        for (std::uint64_t left = records[rank][0]; left > 0;)
          {
            buffer.resize(std::min<std::uint64_t>(message, left));
            MPI_Recv(buffer.data(), buffer.size() * sizeof(Number), MPI_BYTE, rank, tag, comm, MPI_STATUS_IGNORE);
            good = good && write_range(array, buffer.data(), begin, buffer.size()); // a failure still takes the rest
            begin += buffer.size();
            left -= buffer.size();
          }
      const bool closed = array.close() && blocks.close();
      return good && closed ? "" : "'" + name + "' cannot be written: " + errors.reason();
    }

    bool
    write_value(const std::string &path, const hid_t type, const void *value)
    {
      const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
      Hdf5Handle       set  = create_set(handle, path, type, space);
      const bool       good = set && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0;
      return set.close() && good;
    }

    std::string
    write_scalar(const std::string &name, const hid_t type, const void *value)
    {
      if (!is_owner())
        return "";
      if (const std::string reason = reserve(H5Tget_size(type)); !reason.empty())
        return reason;
      const Hdf5Errors    errors;
      const std::uint64_t checksum = block_checksum(value, H5Tget_size(type));
      const bool          good     = write_value(attribute_path(name), type, value) &&
                        write_value(checksum_of(attribute_path(name)), H5T_NATIVE_UINT64, &checksum);
      return good ? "" : "'" + name + "' cannot be written: " + errors.reason();
    }

    std::string
    close()
    {
      if (!handle)
        return "";
      const Hdf5Errors errors;
      hsize_t          size = 0;
      bool             good = H5Fflush(handle, H5F_SCOPE_LOCAL) >= 0 && H5Fget_filesize(handle, &size) >= 0;
      good                  = handle.close() && good;
      std::error_code code;
      if (good)
        fs::resize_file(path, size, code); // gives back what was reserved and not needed
      return good ? (code ? code.message() : "") : "it cannot be closed: " + errors.reason();
    }
  };

  ArchiveWriter::ArchiveWriter(const std::string &path, const MPI_Comm comm)
    : path(path)
    , temporary(path + ".tmp")
    , comm(comm)
    , file(new File{temporary, comm, {}})
  {
    agree(file->create());
    attribute("format", archive_format);
    attribute("n_ranks", static_cast<std::uint64_t>(MPI::n_mpi_processes(comm)));
  }

  ArchiveWriter::~ArchiveWriter()
  {
    if (!file)
      return;
    file->close();
    std::error_code ignored;
    if (MPI::this_mpi_process(comm) == 0)
      fs::remove(temporary, ignored);
  }

  void
  ArchiveWriter::agree(const std::string &local_error)
  {
    error = first_error(local_error, comm);
  }

  template <typename Number>
  void
  ArchiveWriter::write_array(const std::string &name, const dealii::ArrayView<const Number> &block)
  {
    const std::uint64_t bytes = MPI::sum(static_cast<std::uint64_t>(block.size() * sizeof(Number)), comm);
    if (error.empty())
      agree(file->is_owner() ? file->reserve(bytes) : "");
    if (error.empty())
      agree(file->write_array(name, block));
  }

  void
  ArchiveWriter::write(const std::string &name, const dealii::ArrayView<const double> &block)
  {
    write_array(name, block);
  }

  void
  ArchiveWriter::write(const std::string &name, const dealii::ArrayView<const std::uint64_t> &block)
  {
    write_array(name, block);
  }

  void
  ArchiveWriter::attribute(const std::string &name, const std::string &value)
  {
    const std::string text = MPI::broadcast(comm, value, 0);
    const Hdf5Handle  type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type, text.size() + 1);
    H5Tset_cset(type, H5T_CSET_UTF8);
    if (error.empty())
      agree(file->write_scalar(name, type, text.c_str()));
  }

  void
  ArchiveWriter::attribute(const std::string &name, const double value)
  {
    if (error.empty())
      agree(file->write_scalar(name, H5T_NATIVE_DOUBLE, &value));
  }

  void
  ArchiveWriter::attribute(const std::string &name, const std::uint64_t value)
  {
    if (error.empty())
      agree(file->write_scalar(name, H5T_NATIVE_UINT64, &value));
  }

  void
  ArchiveWriter::commit()
  {
    const std::string close_error = file->close();
    if (error.empty())
      agree(close_error);
    file.reset();
    on_root(comm, [&] {
      try
        {
          if (!error.empty())
            throw OutputError(error);
          synchronise(temporary);
          fs::rename(temporary, path);
        }
      catch (const std::exception &exception)
        {
          std::error_code ignored;
          fs::remove(temporary, ignored);
          throw OutputError(path, std::string("the file was not written: ") + exception.what());
        }
    });
  }
} // namespace Stroma::Output
