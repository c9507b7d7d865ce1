#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <utility>

namespace Stroma::Output
{
  /// Owns an identifier of the HDF5 library and closes it.
  class Hdf5Handle
  {
  public:
    Hdf5Handle() = default;
    Hdf5Handle(const hid_t id, herr_t (*close)(hid_t))
      : id(id)
      , closer(close)
    {}
    Hdf5Handle(Hdf5Handle &&other) noexcept
      : id(std::exchange(other.id, -1))
      , closer(other.closer)
    {}
    Hdf5Handle &
    operator=(Hdf5Handle &&other) noexcept
    {
      std::swap(id, other.id);
      std::swap(closer, other.closer);
      return *this;
    }
    ~Hdf5Handle()
    {
      close();
    }

    /// Whether the library gave a valid identifier.
    explicit operator bool() const
    {
      return id >= 0;
    }
    operator hid_t() const
    {
      return id;
    }

    /// Closes now; false if that failed (data still in memory may be lost then).
    bool
    close()
    {
      return id < 0 || closer(std::exchange(id, -1)) >= 0;
    }

  private:
    hid_t id                = -1;
    herr_t (*closer)(hid_t) = nullptr;
  };

  /// Keeps HDF5 from printing its error stack while it lives, and remembers the innermost reason of the first error.
  class Hdf5Errors
  {
  public:
    Hdf5Errors();
    ~Hdf5Errors();
    Hdf5Errors(const Hdf5Errors &)            = delete;
    Hdf5Errors &operator=(const Hdf5Errors &) = delete;

    /// In the library's or the system's words.
    const std::string &
    reason() const
    {
      return text;
    }

  private:
    static herr_t remember(hid_t stack, void *errors);

    H5E_auto2_t old_function = nullptr;
    void       *old_data     = nullptr;
    std::string text;
  };

  /// Creates a file with disk space for @p bytes and 128 kB for the library's own records. Returns the reason if it cannot,
  /// or "". The space is asked for before the library sees the file: HDF5 1.10 complains at the program's end, or crashes,
  /// if it could not complete one.
  std::string create_with_space(Hdf5Handle &file, const std::string &path, std::uint64_t bytes);

  /// Reserves space for @p bytes more and 128 kB for the library's own records; ask before creating a dataset.
  std::string reserve_space(hid_t file, std::uint64_t bytes);
} // namespace Stroma::Output
