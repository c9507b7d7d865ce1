#include <stroma/base/output_error.h>
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
    std::error_code   code;
    std::filesystem::remove(temporary, code); // whatever it is, a link for example
    errno = 0;
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    const int reason = errno;
    code.clear();
    if (out)
      std::filesystem::rename(temporary, path, code);
    if (out && !code)
      return;
    const std::string why = code ? code.message() : std::strerror(reason);
    std::filesystem::remove(temporary, code);
    throw OutputError(path, "the file cannot be written (" + why + ")");
  }

  std::string
  csv_cell(std::string text)
  {
    if (text.find_first_of(",\"\r\n") == std::string::npos)
      return text;
    for (std::size_t quote = 0; (quote = text.find('"', quote)) != std::string::npos; quote += 2)
      text.insert(quote, "\"");
    return '"' + text + '"';
  }

  std::string
  to_text(const double number)
  {
    if (std::isnan(number))
      return "nan";
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
  }
} // namespace Stroma::Output
