#pragma once

#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "../applications/stroma/command_line.h"

/// `stroma` followed by @p words, in this process. Returns its exit code; 4: an exception that the program did not foresee.
inline int
run_words(std::vector<std::string> words)
{
  words.insert(words.begin(), "stroma");
  std::vector<char *> argv;
  for (auto &word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  try
    {
      return Stroma::run_command_line(static_cast<int>(words.size()), argv.data());
    }
  catch (const std::exception &error)
    {
      std::cerr << "stroma: internal error: " << error.what() << std::endl;
      return 4;
    }
}
