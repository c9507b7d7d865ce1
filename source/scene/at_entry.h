#pragma once

#include <stroma/base/errors.h>
#include <stroma/base/text.h>

#include <filesystem>
#include <string>

namespace Stroma
{
  /// Runs @p work; puts the place of the entry before the message of a UserError.
  template <typename Work>
  auto
  at_entry(const std::string &where, const Work &work)
  {
    try
      {
        return work();
      }
    catch (const UserError &error)
      {
        throw UserError(where, error.what());
      }
    catch (const std::filesystem::filesystem_error &error)
      {
        throw UserError(where, shown(error.path1().string()) + ": " + error.code().message());
      }
  }
} // namespace Stroma
