#pragma once

#include <stroma/base/errors.h>

#include <string>

/// The message of the UserError that @p work throws, or "".
template <typename Work>
std::string
message_of(const Work &work)
{
  try
    {
      work();
    }
  catch (const Stroma::UserError &error)
    {
      return error.what();
    }
  return "";
}
