#pragma once

#include <string>
#include <vector>

namespace Stroma
{
  /**
   * A parameter file as text: deal.II's .prm syntax (`subsection`, `end`, `set name = value`, `include file`, `#`
   * comments, `\` at the end of a line continues it), with the place where each entry was given. It knows nothing of
   * which entries exist: that is Parameters' work.
   */
  class ParameterFile
  {
  public:
    struct Entry
    {
      std::vector<std::string> section; ///< enclosing subsections, outermost first
      std::string              name;
      std::string              value;
      std::string              where; ///< "file:line" or "--set Section/name=value"
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

    /// The last entry with this section and name, or nullptr.
    const Entry *find(const std::vector<std::string> &section, const std::string &name) const;

    /// Names of the subsections directly below @p section, in order of appearance.
    std::vector<std::string> subsections(const std::vector<std::string> &section) const;

    /// Where a subsection was first mentioned, or "".
    std::string where(const std::vector<std::string> &section) const;

    const std::vector<Entry> &entries() const { return all; }
    const std::string &path() const { return file_path; }

  private:
    void read_lines(const std::string &text, const std::string &name, unsigned int depth);
    void put(Entry entry);

    struct OpenedSection
    {
      std::vector<std::string> path;
      std::string              where;
    };

    std::vector<Entry>         all;
    std::vector<OpenedSection> sections;
    std::vector<std::string>   open; // while reading
    std::string                file_path;
  };
} // namespace Stroma
