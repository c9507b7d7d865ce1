#pragma once

#include <stroma/base/errors.h>

#include <exception>
#include <string>
#include <vector>

namespace Stroma
{
  /// A parameter file holds an entry or a section that no part of the program knows.
  class UnknownEntry : public UserError
  {
  public:
    using UserError::UserError;
  };

  /// Whether @p text may be @p name misspelt: at most a letter in three is missing, too many or another one.
  bool resembles(const std::string &text, const std::string &name);

  /// @p known, each once, those most like @p name first.
  std::vector<std::string> nearest_first(std::vector<std::string> known, const std::string &name);

  /**
   * Tells what is misspelt before what is missing without it: returns read(), and if that throws a UserError, calls
   * @p document, which reads the same file in Parameters::Mode::document, where entries may be missing and more of them are
   * known. What that finds unknown is thrown instead. Collective if they are.
   */
  template <typename Read, typename Document>
  auto
  unknown_first(const Read &read, const Document &document)
  {
    try
      {
        return read();
      }
    catch (const UserError &)
      {
        try
          {
            document();
          }
        catch (const UnknownEntry &)
          {
            throw;
          }
        catch (const std::exception &) // the first error is to be told
          {}
        throw;
      }
  }
} // namespace Stroma
