// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace impactrig::acquisition {

/// A formula of one variable, as files state conversions of numbers.
struct Formula {
  std::function<double(double)> function{};  ///< none where there is a problem
  std::string problem{};  ///< why it cannot be applied: "has '^', which ..."; "" it can
};

/// Reads a formula of the variable X (or X1, in either case): numbers, + - * /, ** or pow(a, b) for
/// powers, parentheses, and abs, sqrt, exp, ln, log10, sin, cos, tan, asin, acos, atan (with
/// arcsin, arccos, arctan), sinh, cosh, tanh of angles in radians.
///
/// What means one thing to some programs and another to others is a problem: ^ (power, exclusive
/// or) and log (natural, of base 10). So are formulas of more than 4096 characters or 64 levels.
Formula read_formula(std::string_view text);

}  // namespace impactrig::acquisition
