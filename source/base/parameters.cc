#include <stroma/base/characters.h>
#include <stroma/base/formula.h>
#include <stroma/base/parameters.h>
#include <stroma/base/text.h>

#include <deal.II/base/numbers.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <functional>
#include <sstream>

namespace Stroma
{
  namespace
  {
    /// @p path as absolute path if there is such a file, here or in the folder of @p where ("file:line"); else as it is.
    std::string
    found_path(const std::string &path, const std::string &where)
    {
      namespace fs = std::filesystem;
      std::error_code error;
      const fs::path  beside = fs::path(where.substr(0, where.rfind(':'))).parent_path() / path;
      for (const fs::path &candidate : {fs::path(path), beside})
        if (fs::exists(candidate, error))
          return fs::absolute(candidate, error).lexically_normal().string();
      return path;
    }
  } // namespace

  bool
  Range::contains(const double value) const
  {
    return (open_min ? value > min : value >= min) && (open_max ? value < max : value <= max);
  }

  std::string
  Range::text() const
  {
    const bool lower = std::isfinite(min), upper = std::isfinite(max);
    return (lower ? (open_min ? "(" : "[") + shortest(min) : std::string("(-inf")) + ", " +
           (upper ? shortest(max) + (open_max ? ")" : "]") : std::string("inf)"));
  }

  Parameters::Parameters(const ParameterFile &file, const Mode mode)
    : file(file)
    , mode(mode)
  {
    read_units();
    read_constants();
  }

  void
  Parameters::read_constants()
  {
    const auto            section = this->section("Constants",
                                                  "named numbers for use in expressions, each 'set name = number'; pi is known");
    constexpr std::size_t most    = 1000;
    constant_values["pi"]         = dealii::numbers::PI;
    for (const auto &entry : file.entries())
      if (entry.section == current)
        {
          claimed.insert(key(entry.name));
          check_constant_name(entry.where, entry.name);
          if (constant_values.size() > most)
            throw UserError(entry.where, "more than " + grouped(most) + " constants; give less");
          const double value          = number(entry, entry.value, Range::any(), "");
          constant_values[entry.name] = value;
          declare(entry.name, shortest(value), "", "", "number");
        }
  }

  Parameters::Section::Section(Parameters &p)
    : parameters(p)
    , n_exceptions(std::uncaught_exceptions())
  {}

  Parameters::Section::~Section()
  {
    if (std::uncaught_exceptions() == n_exceptions)
      parameters.all_declared();
    parameters.current.pop_back();
  }

  Parameters::Section
  Parameters::section(const std::string &name, const std::string &meaning)
  {
    current.push_back(name);
    const std::string prefix = path_text();
    if (claimed.insert(prefix + "/").second)
      declared.push_back({true, current, "", meaning, "", ""});
    return Section(*this);
  }

  std::vector<std::string>
  Parameters::subsections() const
  {
    return file.subsections(current);
  }

  std::vector<std::string>
  Parameters::names(const std::string &kind) const
  {
    auto all = subsections();
    for (const auto &name : all)
      {
        auto path = current;
        path.push_back(name);
        check_name(file.where(path), kind, name);
      }
    return all;
  }

  bool
  Parameters::given(const std::string &name) const
  {
    return file.find(current, name) != nullptr;
  }

  std::string
  Parameters::path_text() const
  {
    return join(current, "/");
  }

  std::string
  Parameters::key(const std::string &name) const
  {
    return current.empty() ? name : path_text() + "/" + name;
  }

  std::string
  Parameters::where(const std::string &name) const
  {
    const auto *entry = file.find(current, name);
    return entry ? entry->where : where_section() + " ('" + name + "')";
  }

  std::string
  Parameters::where_section() const
  {
    const std::string place = file.where(current);
    return place.empty() ? file.path() + (current.empty() ? "" : ", section " + path_text()) : place;
  }

  const ParameterFile::Entry *
  Parameters::claim(const std::string &name)
  {
    claimed.insert(key(name));
    return file.find(current, name);
  }

  void
  Parameters::declare(const std::string &name, const std::string &value, const std::string &meaning,
                      const std::string &unit, const std::string &allowed)
  {
    auto path = current;
    path.push_back(name);
    if (value_texts.count(key(name)) == 0)
      declared.push_back({false, path, value, meaning, unit, allowed, given(name)});
    value_texts[key(name)] = value;
  }

  double
  Parameters::number(const ParameterFile::Entry &entry, const std::string &text, const Range &range,
                     const std::string &unit) const
  {
    const std::string allowed = "it must be a number in " + range.text() + in_brackets(unit) +
                                (constant_values.size() > 1 ? ", or an expression of the names in section Constants" :
                                                              "");
    const std::string given = "'" + entry.name + "' was given as '" + shown(text) + "'";
    double            value = 0.;
    try
      {
        value = evaluate_formula(text, constant_values);
      }
    catch (const UserError &error)
      {
        throw UserError(entry.where, given + ": " + error.what() + "; " + allowed);
      }
    if (!std::isfinite(value) || !range.contains(value))
      throw UserError(entry.where,
                      given + (shortest(value) == text ? "" : " (= " + shortest(value) + ")") + "; " + allowed);
    return value;
  }

  double
  Parameters::parse_number(const std::string &name, const std::string &text, const std::string &unit,
                           const Range &range) const
  {
    return number({current, name, text, where(name)}, text, range, unit) * si_factor(unit);
  }

  void
  Parameters::add(const std::string &name, double &value, const std::string &meaning, const std::string &unit,
                  const Range &range)
  {
    std::string text = std::isnan(value) ? "" : shortest(value / si_factor(unit));
    if (const auto *entry = claim(name))
      {
        const double given = number(*entry, entry->value, range, unit);
        value              = given * si_factor(unit);
        text               = shortest(given);
      }
    else if (std::isnan(value) && mode == Mode::read)
      throw UserError(where_section(), "'" + name + "' is missing (" + meaning + "); give a number in " + range.text() +
                                         in_brackets(unit));
    declare(name, text, meaning, unit, range.text());
  }

  void
  Parameters::add(const std::string &name, unsigned int &value, const std::string &meaning, const Range &range)
  {
    std::vector<unsigned int> values{value};
    add(name, values, meaning, range, 1);
    value = values[0];
  }

  void
  Parameters::add(const std::string &name, bool &value, const std::string &meaning)
  {
    add_choice<bool>(name, value, meaning, {{"true", true}, {"false", false}});
  }

  void
  Parameters::add(const std::string &name, std::string &value, const std::string &meaning, const bool required)
  {
    if (const auto *entry = claim(name))
      value = entry->value;
    if (required && value.empty() && mode == Mode::read)
      throw UserError(where_section(), "'" + name + "' is missing (" + meaning + ")");
    declare(name, value, meaning, "", "text");
  }

  void
  Parameters::add_file(const std::string &name, std::string &path, const std::string &meaning, const std::string &word)
  {
    const auto *entry = claim(name);
    if (entry)
      path = entry->value;
    if (path.empty() && mode == Mode::read)
      throw UserError(where_section(), "'" + name + "' is missing (" + meaning + ")");
    if (entry && path != word)
      path = found_path(path, entry->where);
    declare(name, path, meaning, "", "text");
  }

  void
  Parameters::add(const std::string &name, std::vector<double> &values, const std::string &meaning,
                  const std::string &unit, const Range &range, const unsigned int n)
  {
    std::vector<std::string> texts;
    for (const double value : values)
      if (!std::isnan(value))
        texts.push_back(shortest(value / si_factor(unit)));
    const std::string count = n > 0 ? std::to_string(n) + " " : "";
    if (const auto *entry = claim(name))
      {
        values.clear();
        texts.clear();
        for (const auto &part : split_outside_parentheses(entry->value, ','))
          {
            const double given = number(*entry, part, range, unit);
            values.push_back(given * si_factor(unit));
            texts.push_back(shortest(given));
          }
        if (n > 0 && values.size() != n)
          throw UserError(entry->where, "'" + name + "' was given as '" + shown(entry->value) + "'; it must be " +
                                          count + "numbers in " + range.text() + in_brackets(unit) +
                                          " separated by commas");
      }
    else if (texts.size() != values.size() && mode == Mode::read)
      throw UserError(where_section(), "'" + name + "' is missing (" + meaning + "); give " + count + "numbers in " +
                                         range.text() + in_brackets(unit));
    declare(name, join(texts, ", "), meaning, unit, count + "numbers in " + range.text());
  }

  void
  Parameters::add(const std::string &name, std::vector<unsigned int> &values, const std::string &meaning,
                  const Range &range, const unsigned int n)
  {
    const auto *entry = claim(name);
    Range       whole = range;
    whole.max         = std::min(range.max, double(largest_whole));
    whole.min         = std::max(range.min, 0.);
    if (entry)
      {
        values.clear();
        for (const auto &part : split_outside_parentheses(entry->value, ','))
          {
            const double given = number(*entry, part, whole, "");
            if (given != std::floor(given))
              throw UserError(entry->where, "'" + name + "' was given as '" + shown(part) +
                                              "'; it must be a whole number in " + whole.text());
            values.push_back(static_cast<unsigned int>(given));
          }
        if (n > 0 && values.size() != n)
          throw UserError(entry->where, "'" + name + "' was given as '" + shown(entry->value) + "'; it must be " +
                                          std::to_string(n) + " whole numbers separated by commas");
      }
    std::vector<std::string> texts;
    for (const unsigned int value : values)
      texts.push_back(std::to_string(value));
    if (texts.empty() && n > 0 && mode == Mode::read)
      throw UserError(where_section(),
                      "'" + name + "' is missing (" + meaning + "); give " + std::to_string(n) + " whole numbers");
    const bool unlimited = whole.max == double(largest_whole); // "inf" is easier to read in the documentation
    declare(name, join(texts, ", "), meaning, "", "whole numbers in " + (unlimited ? range : whole).text());
  }

  void
  Parameters::add(const std::string &name, std::vector<std::string> &values, const std::string &meaning)
  {
    if (const auto *entry = claim(name))
      values = split(entry->value, ',');
    declare(name, join(values, ", "), meaning, "", "words separated by commas");
  }

  std::string
  Parameters::choose(const std::string &name, const std::string &present, const std::string &meaning,
                     const std::vector<std::string> &choices)
  {
    std::string chosen = present;
    if (const auto *entry = claim(name))
      {
        chosen = entry->value;
        if (std::find(choices.begin(), choices.end(), chosen) == choices.end())
          {
            const std::string odd = odd_character(chosen);
            throw UserError(entry->where, "'" + name + "' was given as '" + shown(chosen) + "'" +
                                            (odd.empty() ? "" : ", which holds " + odd) +
                                            "; it must be one of: " + join(choices, ", "));
          }
      }
    declare(name, chosen, meaning, "", join(choices, " | "));
    return chosen;
  }

  std::string
  Parameters::print(const bool documented) const
  {
    std::ostringstream out;
    // A template of a file says what the file says: all else stands there as comments.
    const bool only_given = mode == Mode::document && !file.entries().empty();
    // Entries of a section come before its subsections, whatever the order of declaration.
    const std::function<void(const std::vector<std::string> &)> print_section =
      [&](const std::vector<std::string> &path) {
        const std::string indent(2 * path.size(), ' ');
        const auto        below = [&](const Declared &d) {
          return d.path.size() == path.size() + 1 && std::equal(path.begin(), path.end(), d.path.begin());
        };
        std::size_t width = 0;
        for (const auto &d : declared)
          if (!d.is_section && below(d))
            width = std::max(width, d.path.back().size());
        for (const auto &d : declared)
          if (!d.is_section && below(d))
            {
              if (documented && !d.meaning.empty())
                out << indent << "# " << d.meaning << in_brackets(d.unit) << "; " << d.allowed << '\n';
              const std::string name    = d.path.back();
              const bool        comment = !d.given && (d.value.empty() || only_given);
              out << indent << (comment ? "# set " : "set ") << name << std::string(width - name.size(), ' ') << " = "
                  << ParameterFile::written(d.value) << '\n';
            }
        for (const auto &d : declared)
          if (d.is_section && below(d))
            {
              const std::string comment = only_given && file.where(d.path).empty() ? "# " : "";
              out << '\n';
              if (documented && !d.meaning.empty())
                out << indent << "# " << d.meaning << '\n';
              out << indent << comment << "subsection " << d.path.back() << '\n';
              print_section(d.path);
              out << indent << comment << "end\n";
            }
      };
    print_section({});
    return out.str();
  }
} // namespace Stroma
