// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/formula.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace impactrig::acquisition {
namespace {

using testing::HasSubstr;

double at(const std::string& text, double x) {
  const Formula formula = read_formula(text);
  EXPECT_EQ(formula.problem, "") << text;
  return formula.function ? formula.function(x) : std::nan("");
}

TEST(Formula, FollowsTheRulesOfArithmetic) {
  EXPECT_EQ(at("X", 7), 7);
  EXPECT_EQ(at("2+3*x1", 4), 14);
  EXPECT_EQ(at(" ( 2 + 3 ) * X1 ", 4), 20);
  EXPECT_EQ(at("X-1-2", 10), 7);
  EXPECT_EQ(at("X/4/2", 16), 2);
  EXPECT_EQ(at("-X**2", 3), -9);
  EXPECT_EQ(at("(-X)**2", 3), 9);
  EXPECT_EQ(at("2**-X", 1), 0.5);
  EXPECT_EQ(at("2**3**X", 2), 512);
  EXPECT_EQ(at("2--X", 3), 5);
  EXPECT_EQ(at("+X*-2", 3), -6);
  EXPECT_EQ(at("1.5e-1*X + .5", 2), 0.8);
}

TEST(Formula, HasTheFunctionsOfTheStandard) {
  const double x = 0.3;
  EXPECT_EQ(at("abs(-X)", x), x);
  EXPECT_EQ(at("sqrt(X)", x), std::sqrt(x));
  EXPECT_EQ(at("exp(X)", x), std::exp(x));
  EXPECT_EQ(at("ln(X)", x), std::log(x));
  EXPECT_EQ(at("LOG10(X)", x), std::log10(x));
  EXPECT_EQ(at("sin(X)", x), std::sin(x));
  EXPECT_EQ(at("cos(X)", x), std::cos(x));
  EXPECT_EQ(at("tan(X)", x), std::tan(x));
  EXPECT_EQ(at("asin(X)", x), std::asin(x));
  EXPECT_EQ(at("arcsin(X)", x), std::asin(x));
  EXPECT_EQ(at("acos(X)", x), std::acos(x));
  EXPECT_EQ(at("arccos(X)", x), std::acos(x));
  EXPECT_EQ(at("atan(X)", x), std::atan(x));
  EXPECT_EQ(at("arctan(X)", x), std::atan(x));
  EXPECT_EQ(at("sinh(X)", x), std::sinh(x));
  EXPECT_EQ(at("cosh(X)", x), std::cosh(x));
  EXPECT_EQ(at("tanh(X)", x), std::tanh(x));
  EXPECT_EQ(at("pow(X+1, 2)", x), std::pow(x + 1, 2));
  EXPECT_TRUE(std::isnan(at("sqrt(X)", -1)));
}

TEST(Formula, ThatIsNotUnderstoodSaysWhere) {
  const auto problem = [](const std::string& text) { return read_formula(text).problem; };
  EXPECT_EQ(problem("X + (2"), "is the formula 'X + (2', which ends too early");
  EXPECT_EQ(problem("X2 * 3"), "is the formula 'X2 * 3', which is not understood from 'X2 * 3' on");
  EXPECT_EQ(problem("X & 3"), "is the formula 'X & 3', which is not understood from '& 3' on");
  EXPECT_EQ(problem("2 X"), "is the formula '2 X', which is not understood from 'X' on");
  EXPECT_EQ(problem("pow(X)"), "is the formula 'pow(X)', which is not understood from ')' on");
  EXPECT_EQ(problem(""), "is the formula '', which ends too early");
  EXPECT_EQ(problem("X^2"),
            "is the formula 'X^2': '^' is a power to some programs and an exclusive or to others");
  EXPECT_EQ(problem("log(X)"),
            "is the formula 'log(X)': 'log' is the natural logarithm to some programs and that of "
            "base 10 to others");
}

// Neither the stack of the reader nor that of the calculation grows with the text.
TEST(Formula, ThatIsTooLongOrTooDeepIsRefused) {
  const auto nested = [](int levels, const std::string& open) {
    std::string text;
    for (int i = 0; i < levels; ++i) text += open;
    text += "X";
    return text + std::string(static_cast<std::size_t>(levels), ')');
  };
  EXPECT_EQ(at(nested(31, "1+2*("), 3), std::ldexp(1.0, 31) - 1 + std::ldexp(3.0, 31));
  EXPECT_EQ(read_formula(nested(40, "1+2*(")).problem, "is a formula of over 64 levels");
  EXPECT_EQ(read_formula(std::string(3000, '-')).problem, "is a formula of over 64 levels");
  EXPECT_EQ(at(nested(20, "1+2*1**("), 5), 3);  // three numbers wait on each level
  EXPECT_EQ(read_formula(std::string(4097, ' ')).problem, "is a formula of 4097 characters");
}

}  // namespace
}  // namespace impactrig::acquisition
