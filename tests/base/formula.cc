#include "message_of.h"

#include <stroma/base/formula.h>

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace Stroma;

  TEST(Formula, EvaluatesWhatItAllows)
  {
    const std::map<std::string, double> constants = {{"a", 2.}, {"mu_c", 3.}};
    EXPECT_DOUBLE_EQ(evaluate_formula("a*mu_c + 1e-3", constants), 6.001);
    EXPECT_DOUBLE_EQ(evaluate_formula("-min(a,0.5)^2", constants), -.25);
    EXPECT_DOUBLE_EQ(evaluate_formula("if(a<=2 && mu_c==3, max(1,a), pow(a, 3))", constants), 2.);
    EXPECT_DOUBLE_EQ(evaluate_formula("(a>1) ? .5 : 1.", constants), .5);
    EXPECT_EQ(evaluate_formula("1e-310", constants), 1e-310);
    EXPECT_EQ(evaluate_formula("+2.5E+2", constants), 250.);
  }

  TEST(Formula, RefusesWithTheReason)
  {
    const auto reason = [](const std::string &text) {
      return message_of([&] { evaluate_formula(text, {{"a", 2.}}); });
    };
    EXPECT_EQ(
      reason("0,5"),
      "the comma after '0' stands outside a function's parentheses; decimals are written with a point, as in 0.5");
    EXPECT_EQ(reason("1,5e3*a").substr(0, 23), "the comma after '1' sta");
    EXPECT_EQ(reason("(0,5)").substr(0, 24), "the comma after '(0' sta");
    EXPECT_EQ(reason("min(a,0,5)"), "'min' takes 2 arguments, not 3 (decimals are written with a point)");
    EXPECT_EQ(reason("sin(0,5)"), "'sin' takes 1 argument, not 2 (decimals are written with a point)");
    EXPECT_EQ(reason("a=3"), "'=' assigns; a comparison is '=='");
    EXPECT_EQ(reason("rand()").substr(0, 23), "'rand' is not a functio");
    EXPECT_EQ(reason("rand_seed(1)").substr(0, 28), "'rand_seed' is not a functio");
    EXPECT_EQ(reason("b*a"), "'b' is not known here");
    EXPECT_EQ(reason("2a"), "after the number 2 an operator is missing");
    EXPECT_EQ(reason("1.2.3"), "after the number 1.2 an operator is missing");
    EXPECT_EQ(reason("0x10"), "after the number 0 an operator is missing");
    EXPECT_EQ(reason("inf"), "'inf' is not known here");
    EXPECT_EQ(reason("(a"), "a '(' is not closed");
    EXPECT_EQ(reason("a)"), "a ')' has no '('");
    EXPECT_EQ(reason("a*"), "an operand or operator is missing or out of place");
    EXPECT_EQ(reason(""), "nothing is written there");
    EXPECT_EQ(reason("\u22121"), "it holds U+2212 (minus sign); write it with ASCII characters");
    EXPECT_EQ(reason("a;1"), "';' has no meaning in an expression");
  }

  TEST(Formula, EveryKnownFunctionCanBeUsed)
  {
    for (const auto &[name, n] : known_functions())
      {
        std::string text = name + "(0.5";
        for (unsigned int i = 1; i < n; ++i)
          text += ",1.5";
        EXPECT_NO_THROW(evaluate_formula(text + ")", {})) << name;
      }
  }

  TEST(Formula, ConstantsHaveNamesThatExpressionsTake)
  {
    for (const std::string name : {"x", "y", "z", "t", "pi", "sin", "min", "rand", "a b", "a,b", "\u00e4", "1a", "set"})
      EXPECT_EQ(message_of([&] { check_constant_name("f.prm:1", name); }).empty(), name == "set") << name;
    EXPECT_EQ(message_of([] { check_constant_name("f.prm:1", "mu_c2"); }), "");
  }
} // namespace
