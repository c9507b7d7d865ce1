#include <stroma/output/hdf5_handle.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace Stroma::Output
{
  namespace
  {
    /// One line: the system's message, if the library quotes it, or what the library says.
    std::string
    shorten(std::string text)
    {
      const std::string quote = "error message = '";
      const std::size_t begin = text.find(quote);
      if (begin != std::string::npos)
        text = text.substr(begin + quote.size(), text.find('\'', begin + quote.size()) - begin - quote.size());
      return text.substr(0, text.find('\n'));
    }

    /// Space for @p bytes and the library's records behind the first @p size bytes of an open file. The reason, or "".
    std::string
    allocate(const int descriptor, const std::uint64_t size, const std::uint64_t bytes)
    {
      constexpr std::uint64_t records     = 1 << 17;
      const int               error       = posix_fallocate(descriptor, size, bytes + records);
      const bool              unsupported = error == EOPNOTSUPP || error == EINVAL;
      return error == 0 || unsupported ? "" : std::strerror(error);
    }

    /// Called for the innermost error of a stack first; returns 1 to see no other.
    herr_t
    take_description(unsigned int, const H5E_error2_t *error, void *text)
    {
      if (error->desc)
        *static_cast<std::string *>(text) = shorten(error->desc);
      return 1;
    }
  } // namespace

  Hdf5Errors::Hdf5Errors()
  {
    H5Eget_auto2(H5E_DEFAULT, &old_function, &old_data);
    H5Eset_auto2(H5E_DEFAULT, &remember, this);
  }

  Hdf5Errors::~Hdf5Errors()
  {
    H5Eset_auto2(H5E_DEFAULT, old_function, old_data);
  }

  herr_t
  Hdf5Errors::remember(const hid_t stack, void *errors)
  {
    std::string &text = static_cast<Hdf5Errors *>(errors)->text;
    if (text.empty())
      H5Ewalk2(stack, H5E_WALK_UPWARD, &take_description, &text);
    return 0;
  }

  std::string
  create_with_space(Hdf5Handle &file, const std::string &path, const std::uint64_t bytes)
  {
    const int plain = open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0666);
    if (plain < 0)
      return std::strerror(errno);
    std::string reason = allocate(plain, 0, bytes);
    close(plain);
    if (reason.empty())
      {
        const Hdf5Errors errors;
        file   = {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose};
        reason = file ? reserve_space(file, bytes) : errors.reason();
      }
    if (!file)
      unlink(path.c_str());
    return reason;
  }

  std::string
  reserve_space(const hid_t file, const std::uint64_t bytes)
  {
    void   *descriptor = nullptr;
    hsize_t size       = 0;
    if (H5Fget_vfd_handle(file, H5P_DEFAULT, &descriptor) < 0 || H5Fget_filesize(file, &size) < 0)
      return "the file is not open";
    return allocate(*static_cast<int *>(descriptor), size, bytes);
  }
} // namespace Stroma::Output
