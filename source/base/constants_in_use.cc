#include <stroma/base/constants_in_use.h>
#include <stroma/base/text.h>

#include <algorithm>
#include <cctype>

namespace Stroma
{
  namespace
  {
    const std::vector<std::string> constants = {"Constants"};

    bool
    is_of_name(const unsigned char c)
    {
      return std::isalnum(c) || c == '_';
    }

    /// What has no such name is refused where constants are read.
    bool
    is_a_name(const std::string &name)
    {
      return std::all_of(name.begin(), name.end(), is_of_name);
    }

    bool
    is_in_use(const ParameterFile &file, const std::string &constant)
    {
      return std::any_of(file.entries().begin(), file.entries().end(),
                         [&](const auto &entry) { return mentions(entry, constant); });
    }

    std::string
    used_constants(const ParameterFile &file)
    {
      std::vector<std::string> names;
      for (const auto &entry : file.entries())
        if (entry.section == constants && is_in_use(file, entry.name))
          names.push_back(entry.name);
      return names.empty() ? "none" : join(names, ", ");
    }
  } // namespace

  bool
  mentions(const ParameterFile::Entry &entry, const std::string &constant)
  {
    if (entry.section == constants && entry.name == constant)
      return false;
    const std::string &text = entry.value;
    for (auto at = text.find(constant); at != std::string::npos; at = text.find(constant, at + 1))
      {
        const auto end = at + constant.size();
        if ((at == 0 || !is_of_name(text[at - 1])) && (end == text.size() || !is_of_name(text[end])))
          return true;
      }
    return false;
  }

  ParameterFile
  with_assignments(ParameterFile file, const std::vector<std::string> &assignments)
  {
    for (const auto &assignment : assignments)
      file.set(assignment);
    for (const auto &assignment : assignments)
      for (const auto &entry : file.entries())
        if (entry.section == constants && entry.where == "--set " + shown(assignment) && is_a_name(entry.name) &&
            !is_in_use(file, entry.name))
          throw UserError(entry.where,
                          "no entry uses the constant '" + entry.name + "'; those in use are: " + used_constants(file));
    return file;
  }
} // namespace Stroma
