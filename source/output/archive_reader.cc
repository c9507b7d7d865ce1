#include <stroma/base/errors.h>
#include <stroma/output/archive.h>
#include <stroma/output/archive_layout.h>
#include <stroma/output/collective.h>
#include <stroma/output/hdf5_array.h>

#include <filesystem>

namespace Stroma::Output
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;

    Hdf5Handle
    open_set(const hid_t file, const std::string &name)
    {
      return { H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose };
    }

    bool
    has_type(const hid_t set, const hid_t type)
    {
      const Hdf5Handle stored(H5Dget_type(set), H5Tclose);
      return H5Tequal(stored, type) > 0;
    }

    hsize_t
    length_of(const hid_t set)
    {
      const Hdf5Handle space(H5Dget_space(set), H5Sclose);
      return std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0);
    }

    /// A part of an array and, if it is a rank's own block, its checksum.
    struct Share
    {
      hsize_t       begin = 0, length = 0;
      bool          is_block = false;
      std::uint64_t checksum = 0;
    };

    Share
    even_share(const hsize_t total, const unsigned int rank, const unsigned int n_ranks)
    {
      const hsize_t each = total / n_ranks, rest = total % n_ranks, r = rank;
      return { r * each + std::min(r, rest), each + (r < rest ? 1 : 0) };
    }
  } // namespace

  /// Each rank opens the file by itself and reads only; functions are local and throw UserError without the path.
  struct ArchiveReader::File
  {
    Hdf5Handle   handle;
    unsigned int rank, n_ranks;
    bool         same_ranks = false;

    void
    open(const std::string &path)
    {
      if (!std::filesystem::exists(path))
        throw UserError("there is no such checkpoint");
      handle = { H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose };
      if (!handle)
        throw UserError("not a checkpoint, or a damaged one");
      if (scalar<std::uint64_t>("format") != archive_format)
        throw UserError("a checkpoint of another version of Stroma");
      same_ranks = scalar<std::uint64_t>("n_ranks") == n_ranks;
    }

    template <typename Number>
    Number
    scalar(const std::string &name) const
    {
      const Hdf5Handle set   = open_set(handle, attribute_path(name));
      Number           value = {};
      if (!set || !has_type(set, hdf5_type<Number>())
          || H5Dread(set, hdf5_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0)
        throw UserError("the checkpoint has no readable value '" + name + "'");
      return value;
    }

    std::string
    text(const std::string &name) const
    {
      const Hdf5Handle set = open_set(handle, attribute_path(name));
      const Hdf5Handle type(set ? H5Dget_type(set) : -1, H5Tclose);
      if (!type || H5Tget_class(type) != H5T_STRING)
        throw UserError("the checkpoint has no readable text '" + name + "'");
      std::string value(H5Tget_size(type), '\0');
      if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()) < 0)
        throw UserError("the checkpoint has no readable text '" + name + "'");
      return value.c_str();
    }

    Share
    own_block(const std::string &name, const hsize_t total) const
    {
      const Hdf5Handle           set = open_set(handle, blocks_of(name));
      std::vector<std::uint64_t> blocks(set ? length_of(set) : 0); // length and checksum of each rank
      if (blocks.size() != 2 * n_ranks || !read_range(set, blocks.data(), 0, blocks.size()))
        throw UserError("the blocks of '" + name + "' are damaged");
      Share   share;
      hsize_t sum = 0;
      for (unsigned int r = 0; r < n_ranks; ++r)
      {
        if (r == rank)
          share = { sum, blocks[2 * r], true, blocks[2 * r + 1] };
        sum += blocks[2 * r];
      }
      if (sum != total)
        throw UserError("the blocks of '" + name + "' are damaged");
      return share;
    }

    template <typename Number>
    std::vector<Number>
    array(const std::string &name) const
    {
      const Hdf5Handle set = open_set(handle, name);
      if (!set || !has_type(set, hdf5_type<Number>()))
        throw UserError("the checkpoint has no array '" + name + "' of this type");
      const hsize_t       total = length_of(set);
      const Share         share = same_ranks ? own_block(name, total) : even_share(total, rank, n_ranks);
      std::vector<Number> data(share.length);
      if (!read_range(set, data.data(), share.begin, share.length)
          || (share.is_block && share.checksum != block_checksum(data.data(), data.size() * sizeof(Number))))
        throw UserError("'" + name + "' is damaged");
      return data;
    }

    /// Runs @p work(*this) on all ranks; a failure of any becomes a UserError with the path on all. Collective.
    template <typename Work>
    auto
    collectively(const std::string &path, const MPI_Comm comm, const Work &work)
    {
      decltype(work(*this)) result{};
      const Hdf5Errors      errors;
      std::string           error;
      try
      {
        result = work(*this);
      }
      catch (const std::exception &exception)
      {
        error = path + ": " + exception.what() + (errors.reason().empty() ? "" : " (" + errors.reason() + ")");
      }
      throw_if_any(error, comm);
      return result;
    }
  };

  ArchiveReader::ArchiveReader(const std::string &path, const MPI_Comm comm)
      : path(path), comm(comm), file(new File{ {}, MPI::this_mpi_process(comm), MPI::n_mpi_processes(comm) })
  {
    same_ranks = file->collectively(path, comm,
                                    [&path](File &f)
                                    {
                                      f.open(path);
                                      return f.same_ranks;
                                    });
  }

  ArchiveReader::~ArchiveReader() = default;

  std::vector<double>
  ArchiveReader::read_double(const std::string &name) const
  {
    return file->collectively(path, comm, [&name](const File &f) { return f.array<double>(name); });
  }

  std::vector<std::uint64_t>
  ArchiveReader::read_uint64(const std::string &name) const
  {
    return file->collectively(path, comm, [&name](const File &f) { return f.array<std::uint64_t>(name); });
  }

  std::string
  ArchiveReader::attribute_string(const std::string &name) const
  {
    return file->collectively(path, comm, [&name](const File &f) { return f.text(name); });
  }

  double
  ArchiveReader::attribute_double(const std::string &name) const
  {
    return file->collectively(path, comm, [&name](const File &f) { return f.scalar<double>(name); });
  }

  std::uint64_t
  ArchiveReader::attribute_uint64(const std::string &name) const
  {
    return file->collectively(path, comm, [&name](const File &f) { return f.scalar<std::uint64_t>(name); });
  }

  bool
  ArchiveReader::has(const std::string &name) const
  {
    return file->collectively(path, comm,
                              [&name](const File &f)
                              {
                                const Hdf5Errors silent;
                                return static_cast<bool>(open_set(f.handle, name));
                              });
  }
} // namespace Stroma::Output
