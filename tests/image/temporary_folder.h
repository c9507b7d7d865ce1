#pragma once

#include <stroma/base/errors.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <unistd.h>

/// An empty folder of this test that disappears with it.
class TemporaryFolder : public testing::Test
{
protected:
  TemporaryFolder()
    : folder(std::filesystem::temp_directory_path() / ("stroma_image_" + std::to_string(getpid())))
  {
    std::filesystem::create_directories(folder);
  }

  ~TemporaryFolder() override
  {
    std::filesystem::remove_all(folder);
  }

  std::string
  path(const std::string &name) const
  {
    return (folder / name).string();
  }

  static std::string
  content(const std::string &path)
  {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// Write `bytes` into the folder and return the path.
  std::string
  file(const std::string &name, const std::string &bytes) const
  {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  const std::filesystem::path folder;
};

/// The message of the UserError that `action` throws; empty if it throws none.
template <typename Action>
std::string
user_error(const Action &action)
{
  try
    {
      action();
    }
  catch (const Stroma::UserError &error)
    {
      return error.what();
    }
  return "";
}

/// Expect that `action` throws a one-line UserError that contains each of `parts`.
template <typename Action, typename... Parts>
void
expect_user_error(const Action &action, const Parts &...parts)
{
  const std::string message = user_error(action);
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string &part : {std::string(parts)...})
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in '" << message << "'";
}
