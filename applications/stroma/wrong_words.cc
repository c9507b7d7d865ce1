#include <stroma/base/text.h>
#include <stroma/base/unknown_entries.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>

#include "wrong_words.h"

namespace
{
  using namespace Stroma;

  bool
  has(const std::vector<std::string> &names, const std::string &name)
  {
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  /// "-1" is a number.
  bool
  is_option(const std::string &word)
  {
    const auto first = word.find_first_not_of('-');
    return (first == 1 || first == 2) && std::isalpha(static_cast<unsigned char>(word[first])) != 0;
  }

  /// "--output" of "--output=folder".
  std::string
  name_of(const std::string &option)
  {
    return option.substr(0, option.find('='));
  }

  std::vector<std::string>
  options_of(const CLI::App &command)
  {
    std::vector<std::string> names;
    for (const auto *option : command.get_options())
      {
        for (const auto &name : option->get_lnames())
          names.push_back("--" + name);
        for (const auto &name : option->get_snames())
          names.push_back("-" + name);
      }
    return names;
  }

  std::vector<std::string>
  commands_of(const CLI::App &app)
  {
    std::vector<std::string> names;
    for (const auto *command : app.get_subcommands([](const CLI::App *) { return true; }))
      names.push_back(command->get_name());
    return names;
  }
} // namespace

std::string
Stroma::wrong_words(const CLI::App &app, const CLI::ParseError &error, const std::vector<std::string> &words)
{
  const auto given = app.get_subcommands();
  if (given.empty())
    {
      const auto commands = commands_of(app);
      const auto word     = std::find_if(words.begin(), words.end(), [](const auto &one) { return !is_option(one); });
      if (word != words.end())
        return "'" + shown(*word) + "' is no command; known: " + join(nearest_first(commands, *word), ", ");
      if (words.empty())
        return "no command is given; known: " + join(commands, ", ");
    }
  const auto &command = given.empty() ? app : *given.front();
  const auto  known   = options_of(command);
  for (const auto &word : words)
    if (is_option(word) && !has(known, name_of(word)))
      return "'" + shown(name_of(word)) + "' is no option" +
             (given.empty() ? "" : " of 'stroma " + command.get_name() + "'") +
             "; known: " + join(nearest_first(known, name_of(word)), ", ");
  const auto               left = app.remaining(true);
  std::vector<std::string> unexpected;
  std::copy_if(words.begin(), words.end(), std::back_inserter(unexpected),
               [&](const auto &word) { return has(left, word); });
  return unexpected.empty() ? shown(error.what()) : "not expected: " + shown(join(unexpected, " "));
}
