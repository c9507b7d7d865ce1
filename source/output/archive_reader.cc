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
      return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose};
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
    even_share(const hsize_t total, const unsigned int width, const unsigned int rank, const unsigned int n_ranks)
    {
      const hsize_t n = total / width, each = n / n_ranks, rest = n % n_ranks, r = rank;
      return {width * (r * each + std::min(r, rest)), width * (each + (r < rest ? 1 : 0))};
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
      std::error_code code;
      if (!std::filesystem::exists(path, code))
        throw UserError("there is no such checkpoint");
      handle = {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
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
      if (!set || !has_type(set, hdf5_type<Number>()) ||
          H5Dread(set, hdf5_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0)
        throw UserError("the checkpoint has no readable value '" + name + "'");
      check(name, &value, sizeof(value));
      return value;
    }

    /// That a single value is what was written.
    void
    check(const std::string &name, const void *value, const std::size_t bytes) const
    {
      const Hdf5Handle set      = open_set(handle, checksum_of(attribute_path(name)));
      std::uint64_t    checksum = 0;
      if (!set || !has_type(set, H5T_NATIVE_UINT64) ||
          H5Dread(set, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &checksum) < 0 ||
          checksum != block_checksum(value, bytes))
        throw UserError("'" + name + "' is damaged");
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
      check(name, value.data(), value.size());
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
            share = {sum, blocks[2 * r], true, blocks[2 * r + 1]};
          sum += blocks[2 * r];
        }
      if (sum != total)
        throw UserError("the blocks of '" + name + "' are damaged");
      return share;
    }

    template <typename Number>
    std::vector<Number>
    array(const std::string &name, const unsigned int width) const
    {
      const Hdf5Handle set = open_set(handle, name);
      if (!set || !has_type(set, hdf5_type<Number>()))
        throw UserError("the checkpoint has no array '" + name + "' of this type");
      const hsize_t       total = length_of(set);
      const Share         share = same_ranks ? own_block(name, total) : even_share(total, width, rank, n_ranks);
      std::vector<Number> data(share.length);
      if (!read_range(set, data.data(), share.begin, share.length) ||
          (share.is_block && share.checksum != block_checksum(data.data(), data.size() * sizeof(Number))))
        throw UserError("'" + name + "' is damaged");
      return data;
    }

    /// Whether every n-th block of an array, beginning with this rank's, has its checksum.
    template <typename Number>
    bool
    is_whole(const std::string &name) const
    {
      const Hdf5Handle           set = open_set(handle, name), blocks_set = open_set(handle, blocks_of(name));
      std::vector<std::uint64_t> blocks(blocks_set ? length_of(blocks_set) : 0);
      bool good = set && has_type(set, hdf5_type<Number>()) && read_range(blocks_set, blocks.data(), 0, blocks.size());
      hsize_t begin = 0;
      for (std::size_t b = 0; 2 * b + 1 < blocks.size() && good; begin += blocks[2 * b++])
        if (b % n_ranks == rank)
          {
            good = blocks[2 * b] <= length_of(set); // before so much memory is asked for
            std::vector<Number> data(good ? blocks[2 * b] : 0);
            good = good && read_range(set, data.data(), begin, data.size()) &&
                   block_checksum(data.data(), data.size() * sizeof(Number)) == blocks[2 * b + 1];
          }
      return good;
    }

    /// Name of an array or single value whose checksum does not fit, or "".
    std::string
    damage() const
    {
      const std::string ending = blocks_of(""), values = attribute_path(""), checksum = checksum_of("");
      const auto        ends_with = [](const std::string &name, const std::string &end) {
        return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
      };
      std::vector<std::string> names;
      if (H5Lvisit(handle, H5_INDEX_NAME, H5_ITER_INC, &take_name, &names) < 0)
        return "list of contents";
      for (const std::string &name : names)
        if (ends_with(name, ending))
          {
            const std::string array = name.substr(0, name.size() - ending.size());
            if (!is_whole<double>(array) && !is_whole<std::uint64_t>(array))
              return array;
          }
        else if (ends_with(name, checksum))
          {
            const std::string value = name.substr(0, name.size() - checksum.size());
            if (!is_good_value(value.substr(values.size())))
              return value;
          }
      return "";
    }

    bool
    is_good_value(const std::string &name) const
    {
      const Hdf5Handle set = open_set(handle, attribute_path(name));
      try
        {
          if (has_type(set, H5T_NATIVE_DOUBLE))
            scalar<double>(name);
          else if (has_type(set, H5T_NATIVE_UINT64))
            scalar<std::uint64_t>(name);
          else
            text(name);
          return true;
        }
      catch (const UserError &)
        {
          return false;
        }
    }

    static herr_t
    take_name(hid_t, const char *name, const H5L_info_t *, void *names)
    {
      static_cast<std::vector<std::string> *>(names)->push_back(name);
      return 0;
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
    : path(path)
    , comm(comm)
    , file(new File{{}, MPI::this_mpi_process(comm), MPI::n_mpi_processes(comm)})
  {
    same_ranks = file->collectively(path, comm, [&path](File &f) {
      f.open(path);
      return f.same_ranks;
    });
  }

  ArchiveReader::~ArchiveReader() = default;

  std::string
  ArchiveReader::damage() const
  {
    return first_error(file->collectively(path, comm, [](const File &f) { return f.damage(); }), comm);
  }

  std::vector<double>
  ArchiveReader::read_double(const std::string &name, const unsigned int width) const
  {
    return file->collectively(path, comm, [&](const File &f) { return f.array<double>(name, width); });
  }

  std::vector<std::uint64_t>
  ArchiveReader::read_uint64(const std::string &name, const unsigned int width) const
  {
    return file->collectively(path, comm, [&](const File &f) { return f.array<std::uint64_t>(name, width); });
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
    return file->collectively(path, comm, [&name](const File &f) {
      const Hdf5Errors silent;
      return static_cast<bool>(open_set(f.handle, name));
    });
  }
} // namespace Stroma::Output
