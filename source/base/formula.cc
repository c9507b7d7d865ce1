#include <stroma/base/characters.h>
#include <stroma/base/errors.h>
#include <stroma/base/formula.h>
#include <stroma/base/silence.h>
#include <stroma/base/text.h>

#include <deal.II/base/function_parser.h>

#include <cctype>
#include <cstdlib>
#include <vector>

namespace Stroma
{
  namespace
  {
    bool
    is_digit(const char c)
    {
      return std::isdigit(static_cast<unsigned char>(c)) != 0;
    }

    bool
    begins_name(const char c)
    {
      return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
    }

    /// End of the decimal number that begins at @p begin; @p begin itself if there is none.
    std::size_t
    end_of_number(const std::string &text, const std::size_t begin)
    {
      std::size_t end = begin, digits = 0;
      for (bool point = false; end < text.size() && (is_digit(text[end]) || (text[end] == '.' && !point)); ++end)
        {
          digits += is_digit(text[end]);
          point |= text[end] == '.';
        }
      if (digits == 0)
        return begin;
      if (end < text.size() && (text[end] == 'e' || text[end] == 'E'))
        {
          std::size_t power = end + 1;
          if (power < text.size() && (text[power] == '+' || text[power] == '-'))
            ++power;
          if (power < text.size() && is_digit(text[power]))
            {
              for (end = power; end < text.size() && is_digit(text[end]);)
                ++end;
            }
        }
      return end;
    }

    std::string
    list_of_functions()
    {
      std::vector<std::string> names;
      for (const auto &[name, arguments] : known_functions())
        names.push_back(name);
      return join(names, ", ");
    }

    /// A parenthesis that is open: of which function ("" for none), and how many commas it holds so far.
    struct Open
    {
      std::string  function;
      unsigned int commas;
      bool         empty;
    };

    /// Reads a formula from left to right.
    class Checker
    {
    public:
      Checker(const std::string &text, const std::set<std::string> &names)
        : text(text)
        , names(names)
      {}

      void
      run()
      {
        if (const auto odd = odd_character(text); !odd.empty())
          throw UserError("it holds " + odd + "; write it with ASCII characters");
        while (place < text.size())
          if (text[place] == ' ' || text[place] == '\t')
            ++place;
          else if (is_digit(text[place]) || text[place] == '.')
            number();
          else if (begins_name(text[place]))
            word();
          else
            sign();
        if (!open.empty())
          throw UserError("a '(' is not closed");
      }

    private:
      void
      something()
      {
        if (!open.empty())
          open.back().empty = false;
      }

      void
      number()
      {
        something();
        const std::size_t end = end_of_number(text, place);
        if (end == place)
          throw UserError("'.' is not a number");
        if (end < text.size() && (begins_name(text[end]) || text[end] == '.'))
          throw UserError("after the number " + shown(text.substr(place, end - place)) + " an operator is missing");
        place = end;
      }

      void
      word()
      {
        something();
        std::size_t end = place;
        while (end < text.size() && (begins_name(text[end]) || is_digit(text[end])))
          ++end;
        const std::string word = text.substr(place, end - place);
        const std::size_t next = text.find_first_not_of(" \t", end);
        if (next != std::string::npos && text[next] == '(')
          {
            if (known_functions().count(word) == 0)
              throw UserError("'" + shown(word) + "' is not a function; known: " + list_of_functions());
            if (next != end)
              throw UserError("write '" + word + "(' without a blank");
            open.push_back({word, 0, true});
            place = next + 1;
            return;
          }
        if (names.count(word) == 0)
          throw UserError("'" + shown(word) + "' is not known here");
        place = end;
      }

      void
      sign()
      {
        const char        c    = text[place];
        const std::string two  = text.substr(place, 2);
        const std::size_t from = place++;
        if (c == '(')
          {
            something();
            open.push_back({"", 0, true});
          }
        else if (c == ')')
          close();
        else if (c == ',')
          comma(from);
        else if (two == "==" || two == "!=" || two == "<=" || two == ">=" || two == "&&" || two == "||")
          ++place;
        else if (c == '=')
          throw UserError("'=' assigns; a comparison is '=='");
        else if (std::string("+-*/^<>?:").find(c) == std::string::npos)
          throw UserError("'" + shown(std::string(1, c)) + "' has no meaning in an expression");
      }

      void
      comma(const std::size_t from)
      {
        if (open.empty() || open.back().function.empty())
          throw UserError("the comma after '" + shown(trim(text.substr(0, from))) +
                          "' stands outside a function's parentheses; decimals are written with a point, as in 0.5");
        ++open.back().commas;
      }

      void
      close()
      {
        if (open.empty())
          throw UserError("a ')' has no '('");
        const Open one = open.back();
        open.pop_back();
        something();
        if (one.function.empty())
          return;
        const unsigned int given = one.empty ? 0 : one.commas + 1, wanted = known_functions().at(one.function);
        if (given != wanted)
          throw UserError("'" + one.function + "' takes " + counted(wanted, "argument") + ", not " +
                          std::to_string(given) + (given > wanted ? " (decimals are written with a point)" : ""));
      }

      const std::string           &text;
      const std::set<std::string> &names;
      std::size_t                  place = 0;
      std::vector<Open>            open;
    };
  } // namespace

  const std::map<std::string, unsigned int> &
  known_functions()
  {
    static const std::map<std::string, unsigned int> functions = {
      {"abs", 1},   {"acos", 1},  {"acosh", 1}, {"asin", 1}, {"asinh", 1}, {"atan", 1}, {"atan2", 2},
      {"atanh", 1}, {"ceil", 1},  {"cos", 1},   {"cosh", 1}, {"cot", 1},   {"csc", 1},  {"erfc", 1},
      {"exp", 1},   {"floor", 1}, {"if", 3},    {"int", 1},  {"ln", 1},    {"log", 1},  {"log10", 1},
      {"log2", 1},  {"max", 2},   {"min", 2},   {"pow", 2},  {"rint", 1},  {"sec", 1},  {"sign", 1},
      {"sin", 1},   {"sinh", 1},  {"sqrt", 1},  {"tan", 1},  {"tanh", 1}};
    return functions;
  }

  bool
  plain_number(const std::string &text, double &value)
  {
    const std::size_t begin = text.empty() || (text[0] != '-' && text[0] != '+') ? 0 : 1;
    if (begin == text.size() || end_of_number(text, begin) != text.size())
      return false;
    value = std::strtod(text.c_str(), nullptr);
    return true;
  }

  void
  check_formula(const std::string &text, const std::set<std::string> &names)
  {
    if (trim(text).empty())
      throw UserError("nothing is written there");
    Checker(text, names).run();
  }

  double
  evaluate_formula(const std::string &text, const std::map<std::string, double> &constants)
  {
    double value = 0;
    if (plain_number(text, value))
      return value;
    std::set<std::string> names;
    for (const auto &constant : constants)
      names.insert(constant.first);
    check_formula(text, names);
    try
      {
        const Silence             silence;
        dealii::FunctionParser<1> parser(1);
        parser.initialize("unused_variable", text, constants);
        return parser.value(dealii::Point<1>());
      }
    catch (const std::exception &)
      {
        throw UserError("an operand or operator is missing or out of place");
      }
  }

  void
  check_constant_name(const std::string &where, const std::string &name)
  {
    static const std::set<std::string> taken = {"x", "y", "z", "t", "pi", "free", "unused_variable"};
    std::string                        why;
    for (const char c : name)
      if (!begins_name(c) && !is_digit(c))
        why = "holds other than letters a-z, digits and _";
    if (name.empty() || is_digit(name[0]))
      why = "does not begin with a letter";
    else if (taken.count(name) > 0)
      why = "is taken";
    else if (known_functions().count(name) > 0 || name == "sum" || name == "avg" || name == "rand" ||
             name == "rand_seed")
      why = "is that of a function";
    if (!why.empty())
      throw UserError(where,
                      "the constant's name '" + shown(name) + "' " + why +
                        "; names of constants are made of letters a-z, digits and _, begin with a letter, and are "
                        "none of x, y, z, t, pi and the functions");
  }
} // namespace Stroma
