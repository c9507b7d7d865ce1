#include <stroma/base/text.h>
#include <stroma/simulation/same_scene.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

namespace Stroma
{
  namespace
  {
    struct Value
    {
      std::string text     = "(nothing)";
      bool        is_given = false;
    };

    using Values = std::map<std::string, Value>;

    Values
    parse(const std::string &text)
    {
      Values             values;
      std::istringstream lines(text);
      for (std::string line; std::getline(lines, line);)
        {
          const auto name_end = line.find('\t'), value_end = line.rfind('\t');
          if (name_end != std::string::npos && name_end < value_end)
            values[line.substr(0, name_end)] = {line.substr(name_end + 1, value_end - name_end - 1),
                                                line.substr(value_end + 1) == "given"};
        }
      return values;
    }

    /// Whether two values are one, numbers up to the round-off of writing them in the file's units.
    bool
    is_same(const std::string &a, const std::string &b)
    {
      const auto parts_a = split(a, ','), parts_b = split(b, ',');
      if (parts_a.size() != parts_b.size())
        return false;
      for (std::size_t i = 0; i < parts_a.size(); ++i)
        {
          char        *end_a, *end_b;
          const double x = std::strtod(parts_a[i].c_str(), &end_a), y = std::strtod(parts_b[i].c_str(), &end_b);
          const bool   are_numbers = !parts_a[i].empty() && !parts_b[i].empty() && *end_a == '\0' && *end_b == '\0';
          if (are_numbers ? std::abs(x - y) > 1e-13 * std::abs(x) : parts_a[i] != parts_b[i])
            return false;
        }
      return true;
    }

    bool
    may_differ(const std::string &name, const std::string &free_section)
    {
      const auto is_in = [&](const std::string &section) { return name.rfind(section + "/", 0) == 0; };
      // An image is known by its voxels, wherever its file is.
      const bool is_image = is_in("Bodies") && name.rfind("/File") == name.size() - 5;
      return is_image || is_in("Output") || is_in("Units") || is_in(free_section) || name == "Title" ||
             name == "Time/End" || name == "Memory limit";
    }
  } // namespace

  std::string
  scene_text(const Parameters &parameters, const ParameterFile &file, const std::map<std::string, std::string> &images)
  {
    std::set<std::string> given;
    for (const auto &entry : file.entries())
      given.insert(entry.section.empty() ? entry.name : join(entry.section, "/") + "/" + entry.name);
    std::string text;
    for (const auto &[name, value] : parameters.values())
      text += name + '\t' + value + '\t' + (given.count(name) > 0 ? "given" : "default") + '\n';
    for (const auto &[name, value] : images)
      text += name + '\t' + value + "\tgiven\n";
    return text;
  }

  void
  check_same_scene(const Output::ArchiveReader &archive, const std::string &path, const Parameters &parameters,
                   const ParameterFile &file, const std::map<std::string, std::string> &images,
                   const std::string &advice, const std::string &free_section)
  {
    const std::string version = archive.attribute_string("version");
    if (version != STROMA_VERSION)
      throw UserError(path, "this was written by Stroma " + version + ", this is " STROMA_VERSION "; " + advice);
    const Values before = parse(archive.attribute_string("parameters")),
                 now    = parse(scene_text(parameters, file, images));
    const auto value_in = [](const Values &values, const std::string &name) {
      const auto found = values.find(name);
      return found == values.end() ? Value() : found->second;
    };
    for (const auto *list : {&before, &now})
      for (const auto &entry : *list)
        {
          const std::string &name = entry.first;
          const Value        old = value_in(before, name), present = value_in(now, name);
          if (!is_same(old.text, present.text) && (old.is_given || present.is_given) && !may_differ(name, free_section))
            throw UserError(path, "this is of another scene: '" + name + "' was " + old.text + " and is now " +
                                    present.text + "; " + advice);
        }
  }
} // namespace Stroma
