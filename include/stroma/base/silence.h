#pragma once

#include <iostream>
#include <sstream>

namespace Stroma
{
  /// Keeps libraries from printing to standard error while it lives: deal.II's FunctionParser prints what it also throws.
  class Silence
  {
  public:
    Silence()
      : before(std::cerr.rdbuf(swallowed.rdbuf()))
    {}
    ~Silence()
    {
      std::cerr.rdbuf(before);
    }
    Silence(const Silence &)            = delete;
    Silence &operator=(const Silence &) = delete;

  private:
    std::ostringstream swallowed;
    std::streambuf    *before;
  };
} // namespace Stroma
