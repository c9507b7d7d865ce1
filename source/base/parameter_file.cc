#include <stroma/base/errors.h>
#include <stroma/base/parameter_file.h>
#include <stroma/base/text.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace Stroma
{
  namespace
  {
    /// Cuts the first word off @p line and returns it.
    std::string
    take_word(std::string &line)
    {
      const auto        end  = line.find_first_of(" \t");
      const std::string word = line.substr(0, end);
      line                   = (end == std::string::npos) ? "" : trim(line.substr(end));
      return word;
    }

    std::string
    read_text(const std::string &path, const std::string &asked_from)
    {
      std::ifstream in(path);
      if (!in || std::filesystem::is_directory(path))
        throw UserError(asked_from, "the parameter file '" + path + "' cannot be read; give the path of a .prm file");
      std::ostringstream text;
      text << in.rdbuf();
      return text.str();
    }
  } // namespace

  ParameterFile
  ParameterFile::read(const std::string &path)
  {
    ParameterFile file;
    file.file_path = path;
    file.read_lines(read_text(path, ""), path, 0);
    return file;
  }

  ParameterFile
  ParameterFile::parse(const std::string &text, const std::string &name)
  {
    ParameterFile file;
    file.file_path = name;
    file.read_lines(text, name, 0);
    return file;
  }

  void
  ParameterFile::read_lines(const std::string &text, const std::string &name, const unsigned int depth)
  {
    if (depth > 10)
      throw UserError(name, "files include each other in a circle; remove one 'include'");

    const std::size_t  depth_at_start = open.size();
    std::istringstream in(text);
    std::string        line;
    for (unsigned int number = 1; std::getline(in, line); ++number)
      {
        const std::string where = name + ":" + std::to_string(number);
        line                    = trim(line.substr(0, line.find('#')));
        while (!line.empty() && line.back() == '\\')
          {
            std::string next;
            line.pop_back();
            if (!std::getline(in, next))
              break;
            ++number;
            line += trim(next.substr(0, next.find('#')));
          }
        if (line.empty())
          continue;

        const std::string original = line;
        const std::string keyword  = take_word(line);
        if (keyword == "subsection" && !line.empty())
          {
            open.push_back(line);
            sections.push_back({open, where});
          }
        else if (keyword == "end" && line.empty())
          {
            if (open.size() == depth_at_start)
              throw UserError(where, "'end' without a 'subsection' before it; remove it");
            open.pop_back();
          }
        else if (keyword == "set" && line.find('=') != std::string::npos)
          {
            const auto equal = line.find('=');
            put({open, trim(line.substr(0, equal)), trim(line.substr(equal + 1)), where});
          }
        else if (keyword == "include" && !line.empty())
          {
            const auto path = (std::filesystem::path(name).parent_path() / line).string();
            read_lines(read_text(path, where), path, depth + 1);
          }
        else
          throw UserError(where, "'" + original +
                                   "' is not understood; a line is 'set name = value', 'subsection name', 'end' or "
                                   "'include file'");
      }
    if (open.size() != depth_at_start)
      throw UserError(name, "'subsection " + open.back() + "' is never closed; add an 'end'");
  }

  void
  ParameterFile::put(Entry entry)
  {
    for (auto &known : all)
      if (known.section == entry.section && known.name == entry.name)
        {
          known = std::move(entry);
          return;
        }
    all.push_back(std::move(entry));
  }

  void
  ParameterFile::set(const std::string &assignment)
  {
    const auto        equal = assignment.find('=');
    const std::string where = "--set " + assignment;
    if (equal == std::string::npos)
      throw UserError(where, "expected Section/name=value");

    std::vector<std::string> path;
    std::istringstream       left(assignment.substr(0, equal));
    for (std::string part; std::getline(left, part, '/');)
      path.push_back(trim(part));
    if (path.empty() || path.back().empty())
      throw UserError(where, "expected Section/name=value");

    Entry entry{{path.begin(), path.end() - 1}, path.back(), trim(assignment.substr(equal + 1)), where};
    for (std::size_t n = 1; n <= entry.section.size(); ++n)
      sections.push_back({{path.begin(), path.begin() + n}, where});
    put(std::move(entry));
  }

  ParameterFile
  ParameterFile::without(const std::string &section) const
  {
    const auto    inside = [&](const std::vector<std::string> &path) { return !path.empty() && path[0] == section; };
    ParameterFile rest(*this);
    rest.all.erase(std::remove_if(rest.all.begin(), rest.all.end(), [&](const Entry &e) { return inside(e.section); }),
                   rest.all.end());
    rest.sections.erase(std::remove_if(rest.sections.begin(), rest.sections.end(),
                                       [&](const OpenedSection &s) { return inside(s.path); }),
                        rest.sections.end());
    return rest;
  }

  const ParameterFile::Entry *
  ParameterFile::find(const std::vector<std::string> &section, const std::string &name) const
  {
    const auto entry = std::find_if(all.begin(), all.end(), [&](const Entry &e) {
      return e.section == section && e.name == name;
    });
    return entry == all.end() ? nullptr : &*entry;
  }

  std::vector<std::string>
  ParameterFile::subsections(const std::vector<std::string> &section) const
  {
    std::vector<std::string> names;
    for (const auto &known : sections)
      if (known.path.size() == section.size() + 1 && std::equal(section.begin(), section.end(), known.path.begin()) &&
          std::find(names.begin(), names.end(), known.path.back()) == names.end())
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
