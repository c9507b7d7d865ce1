#include <stroma/base/errors.h>
#include <stroma/output/text_file.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace Stroma::Output
{
  void
  write_atomically(const std::string &path, const std::string &text)
  {
    const std::string temporary = path + ".tmp";
    errno                       = 0;
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    const int       reason = errno;
    std::error_code code;
    if (out)
      std::filesystem::rename(temporary, path, code);
    if (out && !code)
      return;
    const std::string why = code ? code.message() : std::strerror(reason);
    std::filesystem::remove(temporary, code);
    throw UserError(path, "the file cannot be written (" + why + ")");
  }

  std::string
  to_text(const double number)
  {
    if (std::isnan(number))
      return "nan";
    std::array<char, 32> text;
    return { text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr };
  }
} // namespace Stroma::Output
