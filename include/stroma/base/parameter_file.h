#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace Stroma
{
  /**
   * A parameter file as text: deal.II's .prm syntax (`subsection`, `end`, `set name = value`, `include file`, `#`
   * comments, `\` at the end of a line continues it), with the place where each entry was given. A value that begins
   * with `"` ends with `"` and may hold `#`; `""` inside it is one quotation mark. It knows nothing of which entries
   * exist: that is Parameters' work.
   *
   * Nothing is given twice in one file, neither an entry nor a section. A file may override what it has included before,
   * and `set()` (of --set) overrides all. Invisible characters outside comments are refused by their code, and so is what
   * is no plain file or exceeds the limits on size, depth and number.
   */
  class ParameterFile
  {
  public:
    struct Entry
    {
      std::vector<std::string> section; ///< enclosing subsections, outermost first
      std::string              name;
      std::string              value;
      std::string              where;    ///< "file:line" or "--set Section/name=value"
      unsigned int             file = 0; ///< which of the files read so far gave it
    };

    ParameterFile() = default;

    /// Reads @p path and what it includes (relative to the including file). Throws UserError with file and line.
    static ParameterFile read(const std::string &path);
    /// The same for a text; @p name stands for the file in messages.
    static ParameterFile parse(const std::string &text, const std::string &name);

    /// Overrides or adds one entry from "Section/Sub/name=value".
    void set(const std::string &assignment);

    /// The same file without a top-level section.
    ParameterFile without(const std::string &section) const;
    /// The same file with nothing but these top-level sections.
    ParameterFile only(const std::vector<std::string> &sections) const;

    /// The last entry with this section and name, or nullptr.
    const Entry *find(const std::vector<std::string> &section, const std::string &name) const;

    /// Names of the subsections directly below @p section, in order of appearance.
    std::vector<std::string> subsections(const std::vector<std::string> &section) const;

    /// Where a subsection was first mentioned, or "".
    std::string where(const std::vector<std::string> &section) const;

    const std::vector<Entry> &
    entries() const
    {
      return all;
    }
    const std::string &
    path() const
    {
      return file_path;
    }

    /// @p value as it can be written in a file: in quotation marks where it needs them.
    static std::string written(const std::string &value);

  private:
    class Reader;
    using Key = std::pair<std::vector<std::string>, std::string>;

    struct OpenedSection
    {
      std::vector<std::string> path;
      std::string              where;
      unsigned int             file = 0;
    };

    void put(Entry entry);
    template <typename Unwanted>
    ParameterFile rest(const Unwanted &unwanted) const;
    void          number_entries();

    std::vector<Entry>         all;
    std::map<Key, std::size_t> places; ///< of each entry in `all`
    std::vector<OpenedSection> sections;
    std::string                file_path;
  };
} // namespace Stroma
