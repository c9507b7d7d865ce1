// What a parameter file holds and nobody declared.

#include <stroma/base/parameters.h>
#include <stroma/base/text.h>
#include <stroma/base/unknown_entries.h>

#include <algorithm>
#include <map>
#include <utility>

namespace Stroma
{
  namespace
  {
    /// Letters to put in, take out or change so that @p a becomes @p b; all of them where @p b is no name any more.
    std::size_t
    edit_distance(const std::string &a, const std::string &b)
    {
      constexpr std::size_t longest_name = 100;
      if (b.size() > longest_name)
        return b.size();
      std::vector<std::size_t> row(b.size() + 1);
      for (std::size_t j = 0; j <= b.size(); ++j)
        row[j] = j;
      for (std::size_t i = 1; i <= a.size(); ++i)
        {
          std::size_t diagonal = row[0];
          row[0]               = i;
          for (std::size_t j = 1; j <= b.size(); ++j)
            {
              const std::size_t above = row[j];
              row[j]   = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
              diagonal = above;
            }
        }
      return row[b.size()];
    }

    [[noreturn]] void
    fail_section(const std::string &where, const std::string &path, const std::vector<std::string> &known)
    {
      const std::string name = path.substr(path.rfind('/') + 1);
      throw UnknownEntry(where, "section '" + shown(path) + "' is not used by this scene" +
                                  (known.empty() ? "" : "; known here: " + join(nearest_first(known, name), ", ")));
    }
  } // namespace

  std::vector<std::string>
  nearest_first(std::vector<std::string> known, const std::string &name)
  {
    std::sort(known.begin(), known.end(), [&](const std::string &a, const std::string &b) {
      return std::make_pair(edit_distance(a, name), a) < std::make_pair(edit_distance(b, name), b);
    });
    known.erase(std::unique(known.begin(), known.end()), known.end());
    return known;
  }

  bool
  resembles(const std::string &text, const std::string &name)
  {
    return 3 * edit_distance(name, text) <= name.size();
  }

  void
  Parameters::all_declared()
  {
    complete.insert(current);
  }

  std::vector<std::string>
  Parameters::declared_in(const Path &section, const bool are_sections) const
  {
    std::vector<std::string> names;
    for (const auto &d : declared)
      if (d.is_section == are_sections && std::equal(d.path.begin(), d.path.end() - 1, section.begin(), section.end()))
        names.push_back(d.path.back());
    return names;
  }

  std::vector<std::string>
  Parameters::declared_sections() const
  {
    return declared_in({}, true);
  }

  /// Throws UnknownEntry for the one of @p entries, all of one section, that nobody declared and is most like a known name.
  void
  Parameters::check_entries(const std::vector<const ParameterFile::Entry *> &entries) const
  {
    const Path                 &section = entries.front()->section;
    const std::string           path    = join(section, "/");
    const ParameterFile::Entry *unknown = nullptr;
    std::vector<std::string>    known;
    std::size_t                 least = 0;
    for (const auto *entry : entries)
      if (claimed.count((path.empty() ? "" : path + "/") + entry->name) == 0)
        {
          const auto        names    = nearest_first(declared_in(section, false), entry->name);
          const std::size_t distance = names.empty() ? 0 : edit_distance(names.front(), entry->name);
          if (unknown && distance >= least)
            continue;
          unknown = entry;
          known   = names;
          least   = distance;
        }
    if (unknown)
      throw UnknownEntry(unknown->where, "'" + shown(unknown->name) + "' is not a parameter " +
                                           (path.empty() ? "at the top level" : "of section '" + shown(path) + "'") +
                                           " of this scene; known here: " + join(known, ", "));
  }

  std::vector<std::vector<const ParameterFile::Entry *>>
  Parameters::entries_by_section() const
  {
    std::vector<std::vector<const ParameterFile::Entry *>> all;
    std::map<Path, std::size_t>                            number;
    for (const auto &entry : file.entries())
      {
        const auto [place, is_new] = number.emplace(entry.section, all.size());
        if (is_new)
          all.emplace_back();
        all[place->second].push_back(&entry);
      }
    return all;
  }

  void
  Parameters::finish(const std::vector<std::string> &read_by_others) const
  {
    for (const auto &entries : entries_by_section())
      {
        Path section;
        for (const auto &name : entries.front()->section)
          {
            const Path parent = section;
            section.push_back(name);
            if (claimed.count(join(section, "/") + "/") == 0)
              {
                auto known = declared_in(parent, true);
                if (parent.empty())
                  known.insert(known.end(), read_by_others.begin(), read_by_others.end());
                fail_section(file.where(section), join(section, "/"), known);
              }
          }
        check_entries(entries);
      }
  }

  void
  Parameters::finish_declared(const std::vector<std::string> &known_sections) const
  {
    for (const auto &entries : entries_by_section())
      {
        const Path &section = entries.front()->section;
        if (complete.count(section) > 0)
          check_entries(entries);
        if (!known_sections.empty() && !section.empty() &&
            std::find(known_sections.begin(), known_sections.end(), section[0]) == known_sections.end())
          fail_section(file.where({section[0]}), section[0], known_sections);
      }
  }
} // namespace Stroma
