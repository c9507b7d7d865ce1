#pragma once

#include <string>
#include <vector>

namespace CLI
{
  class App;
  class ParseError;
} // namespace CLI

namespace Stroma
{
  /**
   * What is wrong with a command line, for people: an unknown command or option with those that there are, whatever else is
   * wrong because of it.
   *
   * @param error with which @p app took them not
   * @param words of the command line but for the program's name
   */
  std::string wrong_words(const CLI::App &app, const CLI::ParseError &error, const std::vector<std::string> &words);
} // namespace Stroma
