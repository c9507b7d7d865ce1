#include <stroma/base/characters.h>
#include <stroma/base/errors.h>
#include <stroma/base/parameter_file.h>
#include <stroma/base/text.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace Stroma
{
  namespace
  {
    constexpr std::size_t largest_text = 16 << 20, most_entries = 100000, most_files = 1000, deepest_section = 20,
                          deepest_include = 10;

    /// Cuts the first word off @p line and returns it.
    std::string
    take_word(std::string &line)
    {
      const auto        end  = line.find_first_of(" \t");
      const std::string word = line.substr(0, end);
      line                   = (end == std::string::npos) ? "" : trim(line.substr(end));
      return word;
    }

    /// The text of a plain file; devices, pipes and folders are refused before anything is read of them.
    std::string
    read_text(const std::string &path, const std::string &asked_from)
    {
      const std::string what = "the parameter file '" + shown(path) + "' ";
      std::error_code   error;
      const auto        status = std::filesystem::status(path, error);
      if (!std::filesystem::exists(status))
        throw UserError(asked_from, what + "cannot be read; give the path of a .prm file");
      if (!std::filesystem::is_regular_file(status))
        throw UserError(asked_from, what + "is no plain file; give the path of a .prm file");
      const auto    size = std::filesystem::file_size(path, error);
      std::ifstream in(path, std::ios::binary);
      if (error || !in)
        throw UserError(asked_from, what + "cannot be read; give the path of a .prm file");
      if (size > largest_text)
        throw UserError(asked_from, what + "is " + grouped(size) + " bytes long, more than the " +
                                      grouped(largest_text) + " that a parameter file may have");
      std::string text(size, ' ');
      in.read(text.data(), static_cast<std::streamsize>(size));
      text.resize(static_cast<std::size_t>(in.gcount()));
      return text;
    }

    /// @p text without a byte-order mark; throws for other encodings and line ends than LF and CR LF.
    std::string
    plain_text(const std::string &text, const std::string &name)
    {
      const bool mark = text.compare(0, 3, "\xEF\xBB\xBF") == 0;
      if (text.compare(0, 2, "\xFF\xFE") == 0 || text.compare(0, 2, "\xFE\xFF") == 0)
        throw UserError(name, "this is a UTF-16 file; save it as UTF-8");
      for (auto place = text.find('\r'); place != std::string::npos; place = text.find('\r', place + 1))
        if (place + 1 < text.size() && text[place + 1] != '\n')
          throw UserError(
            name + ":" + std::to_string(1 + std::count(text.begin(), text.begin() + place, '\n')),
            "a carriage return (U+000D) ends this line, as on old Macintoshes; save the file with line ends LF "
            "or CR LF");
      return text.substr(mark ? 3 : 0);
    }

    /// Place behind the quotation mark that closes the one at @p begin; npos if there is none.
    std::size_t
    end_of_quoted(const std::string &line, std::size_t begin)
    {
      while (true)
        {
          const auto mark = line.find('"', begin + 1);
          if (mark == std::string::npos || mark + 1 == line.size() || line[mark + 1] != '"')
            return mark == std::string::npos ? mark : mark + 1;
          begin = mark + 1;
        }
    }

    /// Where the value of 'set name = "value"' begins; npos for other lines.
    std::size_t
    begin_of_quoted(const std::string &line)
    {
      const auto equal = std::min(line.find('='), line.size());
      if (line.find('#') < equal || equal == line.size())
        return std::string::npos;
      const auto first = line.find_first_not_of(" \t", equal + 1);
      return first != std::string::npos && line[first] == '"' ? first : std::string::npos;
    }

    std::string
    without_comment(const std::string &line)
    {
      const auto quoted = begin_of_quoted(line);
      const auto end    = quoted == std::string::npos ? 0 : end_of_quoted(line, quoted);
      return trim(line.substr(0, end == std::string::npos ? end : line.find('#', end)));
    }

    /// A value without its quotation marks.
    std::string
    unquoted(const std::string &value, const std::string &where)
    {
      if (value.empty() || value[0] != '"')
        return value;
      if (end_of_quoted(value, 0) != value.size())
        throw UserError(where, "the quotation marks of " + shown(value) +
                                 " must stand around the whole value; '\"\"' inside "
                                 "them is one mark");
      std::string inside;
      for (std::size_t i = 1; i + 1 < value.size(); ++i)
        {
          inside += value[i];
          if (value[i] == '"')
            ++i;
        }
      return inside;
    }

    void
    check_characters(const std::string &line, const std::string &where)
    {
      if (const auto character = invisible_character(line); !character.empty())
        throw UserError(where, "'" + shown(line) + "' holds " + character + ", which cannot be seen; remove it");
    }

    std::string
    path_text(const std::vector<std::string> &section, const std::string &name)
    {
      return (section.empty() ? "" : join(section, "/") + "/") + name;
    }
  } // namespace

  /// Reads lines and included files into a ParameterFile.
  class ParameterFile::Reader
  {
  public:
    explicit Reader(ParameterFile &file)
      : file(file)
    {}

    void
    read(const std::string &raw, const std::string &name)
    {
      if (open_files.size() > deepest_include)
        throw UserError(name, "files include each other in a circle, or more than " + std::to_string(deepest_include) +
                                " deep; remove one 'include'");
      total += raw.size();
      if (total > largest_text || ++n_files > most_files)
        throw UserError(name, "this file and those included before hold more than " + grouped(largest_text) +
                                " bytes or are "
                                "more than " +
                                grouped(most_files) + "; include less");
      open_files.push_back(n_files);
      const std::size_t  depth_at_start = open.size();
      std::istringstream in(plain_text(raw, name));
      std::string        line;
      for (unsigned int number = 1; std::getline(in, line); ++number)
        {
          const std::string where = name + ":" + std::to_string(number);
          line                    = without_comment(line);
          while (!line.empty() && line.back() == '\\')
            {
              std::string next;
              line.pop_back();
              if (!std::getline(in, next))
                break;
              ++number;
              line += trim(next.substr(0, next.find('#')));
            }
          if (!line.empty())
            take(line, where, name, depth_at_start);
        }
      if (open.size() != depth_at_start)
        throw UserError(section_files.at(open).first,
                        "'subsection " + shown(open.back()) + "' is never closed; add an 'end'");
      open_files.pop_back();
    }

  private:
    void
    take(std::string line, const std::string &where, const std::string &name, const std::size_t depth_at_start)
    {
      const std::string original = line;
      const std::string keyword  = take_word(line);
      // Lines of an included file are not shown: it may be no parameter file, and not meant to be read by others.
      const bool may_show = open_files.size() == 1;
      if (may_show || keyword == "set" || keyword == "subsection" || keyword == "include")
        check_characters(original, where);
      if (keyword == "subsection" && !line.empty())
        enter(line, where);
      else if (keyword == "end" && line.empty())
        {
          if (open.size() == depth_at_start)
            throw UserError(where, "'end' without a 'subsection' before it; remove it");
          open.pop_back();
        }
      else if (keyword == "set" && line.find('=') != std::string::npos)
        assign(line, where);
      else if (keyword == "include" && !line.empty())
        {
          const auto path = (std::filesystem::path(name).parent_path() / unquoted(line, where)).string();
          read(read_text(path, where), path);
        }
      else
        throw UserError(where, (may_show ? "'" + shown(original) + "'" : std::string("this line")) +
                                 " is not understood; a line is 'set name = value', 'subsection name', 'end' or "
                                 "'include file'");
    }

    void
    enter(const std::string &section, const std::string &where)
    {
      check_title(section, "section", where);
      open.push_back(section);
      if (open.size() > deepest_section)
        throw UserError(where,
                        "sections are more than " + std::to_string(deepest_section) + " deep; an 'end' is missing");
      const auto known = section_files.find(open);
      if (known != section_files.end() && is_open(known->second.second))
        throw UserError(where, "section '" + shown(join(open, "/")) + "' stands twice: it was opened already at " +
                                 known->second.first + "; put its entries into one, or rename one");
      section_files[open] = {where, n_files_now()};
      file.sections.push_back({open, where, n_files_now()});
      check_number(where);
    }

    void
    assign(const std::string &line, const std::string &where)
    {
      const auto  equal = line.find('=');
      const Entry entry{open, trim(line.substr(0, equal)), unquoted(trim(line.substr(equal + 1)), where), where,
                        n_files_now()};
      if (entry.name.empty())
        throw UserError(where, "'set " + shown(line) + "' names no entry; a line is 'set name = value'");
      check_title(entry.name, "entry", where);
      const Entry *known = file.find(open, entry.name);
      if (known && is_open(known->file))
        throw UserError(where,
                        "'" + path_text(open, entry.name) + "' is given twice: it was given already at " +
                          known->where +
                          (known->file == n_files_now() ? "; remove one of the two" :
                                                          "; a file overrides only what it has included before"));
      file.put(entry);
      check_number(where);
    }

    static void
    check_title(const std::string &title, const std::string &kind, const std::string &where)
    {
      if (title.find('/') != std::string::npos)
        throw UserError(where, "the name of the " + kind + " '" + shown(title) +
                                 "' holds '/'; open the section by 'subsection' "
                                 "('Section/name' is for --set)");
      for (const std::string mark : {"\u2018", "\u2019", "\u201C", "\u201D", "\u2013", "\u2014", "\u2212"})
        if (title.find(mark) != std::string::npos)
          throw UserError(where, "the name of the " + kind + " '" + shown(title) + "' holds " + odd_character(mark) +
                                   "; write ' or - instead");
    }

    void
    check_number(const std::string &where) const
    {
      if (file.all.size() + file.sections.size() > most_entries)
        throw UserError(where, "more than " + grouped(most_entries) + " entries and sections; give less");
    }

    unsigned int
    n_files_now() const
    {
      return open_files.back();
    }

    /// Whether what file number @p number gave stands in this file or in one that includes it.
    bool
    is_open(const unsigned int number) const
    {
      return std::find(open_files.begin(), open_files.end(), number) != open_files.end();
    }

    ParameterFile                                                           &file;
    std::vector<std::string>                                                 open;
    std::vector<unsigned int>                                                open_files; ///< numbers, outermost first
    std::map<std::vector<std::string>, std::pair<std::string, unsigned int>> section_files;
    unsigned int                                                             n_files = 0;
    std::size_t                                                              total   = 0;
  };

  ParameterFile
  ParameterFile::read(const std::string &path)
  {
    ParameterFile file;
    file.file_path = path;
    Reader(file).read(read_text(path, ""), path);
    return file;
  }

  ParameterFile
  ParameterFile::parse(const std::string &text, const std::string &name)
  {
    ParameterFile file;
    file.file_path = name;
    Reader(file).read(text, name);
    return file;
  }

  std::string
  ParameterFile::written(const std::string &value)
  {
    const bool plain = value.find('#') == std::string::npos && value == trim(value) &&
                       (value.empty() || (value.front() != '"' && value.back() != '\\'));
    if (plain)
      return value;
    std::string text = "\"";
    for (const char c : value)
      text += c == '"' ? "\"\"" : std::string(1, c);
    return text + "\"";
  }

  void
  ParameterFile::put(Entry entry)
  {
    const auto [known, is_new] = places.emplace(Key{entry.section, entry.name}, all.size());
    if (is_new)
      all.push_back(std::move(entry));
    else
      all[known->second] = std::move(entry);
  }

  void
  ParameterFile::number_entries()
  {
    places.clear();
    for (std::size_t i = 0; i < all.size(); ++i)
      places[{all[i].section, all[i].name}] = i;
  }

  void
  ParameterFile::set(const std::string &assignment)
  {
    const auto        equal = assignment.find('=');
    const std::string where = "--set " + shown(assignment);
    if (equal == std::string::npos)
      throw UserError(where, "expected Section/name=value");
    check_characters(assignment, "--set");

    std::vector<std::string> path;
    std::istringstream       left(assignment.substr(0, equal));
    for (std::string part; std::getline(left, part, '/');)
      path.push_back(trim(part));
    if (path.empty() || path.back().empty())
      throw UserError(where, "expected Section/name=value");

    Entry entry{{path.begin(), path.end() - 1},
                path.back(),
                unquoted(trim(assignment.substr(equal + 1)), where),
                where};
    for (std::size_t n = 1; n <= entry.section.size(); ++n)
      sections.push_back({{path.begin(), path.begin() + n}, where});
    put(std::move(entry));
  }

  /// @param unwanted says of the path of a section whether it is left out
  template <typename Unwanted>
  ParameterFile
  ParameterFile::rest(const Unwanted &unwanted) const
  {
    ParameterFile rest(*this);
    rest.all.erase(std::remove_if(rest.all.begin(), rest.all.end(),
                                  [&](const Entry &e) { return unwanted(e.section); }),
                   rest.all.end());
    rest.sections.erase(std::remove_if(rest.sections.begin(), rest.sections.end(),
                                       [&](const OpenedSection &s) { return unwanted(s.path); }),
                        rest.sections.end());
    rest.number_entries();
    return rest;
  }

  ParameterFile
  ParameterFile::without(const std::string &section) const
  {
    return rest([&](const std::vector<std::string> &path) { return !path.empty() && path[0] == section; });
  }

  ParameterFile
  ParameterFile::only(const std::vector<std::string> &sections) const
  {
    return rest([&](const std::vector<std::string> &path) {
      return path.empty() || std::find(sections.begin(), sections.end(), path[0]) == sections.end();
    });
  }

  const ParameterFile::Entry *
  ParameterFile::find(const std::vector<std::string> &section, const std::string &name) const
  {
    const auto place = places.find({section, name});
    return place == places.end() ? nullptr : &all[place->second];
  }

  std::vector<std::string>
  ParameterFile::subsections(const std::vector<std::string> &section) const
  {
    std::vector<std::string> names;
    std::set<std::string>    seen;
    for (const auto &known : sections)
      if (known.path.size() == section.size() + 1 && std::equal(section.begin(), section.end(), known.path.begin()) &&
          seen.insert(known.path.back()).second)
        names.push_back(known.path.back());
    return names;
  }

  std::string
  ParameterFile::where(const std::vector<std::string> &section) const
  {
    for (const auto &known : sections)
      if (known.path == section)
        return known.where;
    return "";
  }
} // namespace Stroma
