#pragma once

#include <map>
#include <set>
#include <string>

namespace Stroma
{
  /**
   * What an expression in a parameter file may hold, checked before muParser sees it: muParser also takes assignments,
   * random numbers, and commas outside functions ("0,5" is 5 to it).
   */

  /// Whether @p text is a plain decimal number, and its value (subnormal ones too). No hexadecimal, inf or nan.
  bool plain_number(const std::string &text, double &value);

  /**
   * Throws UserError with the reason (no place) unless @p text is an expression of numbers, + - * / ^, comparisons,
   * && and ||, parentheses, the functions of known_functions() with their number of arguments, and @p names.
   */
  void check_formula(const std::string &text, const std::set<std::string> &names);

  /// The value of an expression of @p constants. Throws UserError with the reason (no place); may be infinite or NaN.
  double evaluate_formula(const std::string &text, const std::map<std::string, double> &constants);

  /// Functions of an expression -> their number of arguments.
  const std::map<std::string, unsigned int> &known_functions();

  /// Throws UserError naming @p where if @p name cannot be the name of a constant.
  void check_constant_name(const std::string &where, const std::string &name);
} // namespace Stroma
