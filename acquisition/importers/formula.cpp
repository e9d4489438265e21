// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/formula.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t longest = 4096;
constexpr int deepest = 64;
constexpr std::size_t most_waiting = 256;  ///< numbers at once: three a level at most

/// A step of the calculation: puts a number on the stack, or replaces its top.
struct Step {
  enum class Kind { number, variable, add, subtract, multiply, divide, power, negate, function };
  Kind kind;
  double number = 0.0;
  double (*function)(double) = nullptr;
};

double calculated(const std::vector<Step>& steps, double x) {
  std::array<double, most_waiting> stack{};
  std::size_t size = 0;
  for (const Step& step : steps) {
    if (step.kind == Step::Kind::number || step.kind == Step::Kind::variable) {
      stack[size++] = step.kind == Step::Kind::number ? step.number : x;
      continue;
    }
    if (step.kind == Step::Kind::negate || step.kind == Step::Kind::function) {
      double& top = stack[size - 1];
      top = step.kind == Step::Kind::negate ? -top : step.function(top);
      continue;
    }
    const double right = stack[--size];
    double& left = stack[size - 1];
    if (step.kind == Step::Kind::add) left += right;
    if (step.kind == Step::Kind::subtract) left -= right;
    if (step.kind == Step::Kind::multiply) left *= right;
    if (step.kind == Step::Kind::divide) left /= right;
    if (step.kind == Step::Kind::power) left = std::pow(left, right);
  }
  return stack[0];
}

constexpr auto functions = std::to_array<std::pair<std::string_view, double (*)(double)>>({
    {"abs", [](double x) { return std::abs(x); }},
    {"sqrt", [](double x) { return std::sqrt(x); }},
    {"exp", [](double x) { return std::exp(x); }},
    {"ln", [](double x) { return std::log(x); }},
    {"log10", [](double x) { return std::log10(x); }},
    {"sin", [](double x) { return std::sin(x); }},
    {"cos", [](double x) { return std::cos(x); }},
    {"tan", [](double x) { return std::tan(x); }},
    {"asin", [](double x) { return std::asin(x); }},
    {"arcsin", [](double x) { return std::asin(x); }},
    {"acos", [](double x) { return std::acos(x); }},
    {"arccos", [](double x) { return std::acos(x); }},
    {"atan", [](double x) { return std::atan(x); }},
    {"arctan", [](double x) { return std::atan(x); }},
    {"sinh", [](double x) { return std::sinh(x); }},
    {"cosh", [](double x) { return std::cosh(x); }},
    {"tanh", [](double x) { return std::tanh(x); }},
});

struct Problem {
  std::string what;
};

/// Reads by descent: sum, product, sign, power, and what stands in parentheses.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  std::vector<Step> steps() {
    if (text_.size() > longest)
      throw Problem{fmt::format("is a formula of {} characters", text_.size())};
    sum();
    if (at_ < text_.size()) unexpected();
    return std::move(steps_);
  }

 private:
  [[noreturn]] void unexpected() const {
    if (at_ >= text_.size())
      throw Problem{fmt::format("is the formula '{}', which ends too early", told())};
    if (text_[at_] == '^')
      throw Problem{fmt::format(
          "is the formula '{}': '^' is a power to some programs and an exclusive or to others",
          told())};
    throw Problem{fmt::format("is the formula '{}', which is not understood from '{}' on", told(),
                              to_utf8(text_.substr(at_, 20)))};
  }

  std::string told() const { return to_utf8(text_.substr(0, 80)); }

  char next() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  bool take(std::string_view sign) {
    next();
    if (!text_.substr(at_).starts_with(sign)) return false;
    at_ += sign.size();
    return true;
  }

  void need(std::string_view sign) {
    if (!take(sign)) unexpected();
  }

  void sum() {
    if (++depth_ > deepest) throw Problem{fmt::format("is a formula of over {} levels", deepest)};
    product();
    for (;;) {
      if (take("+")) {
        product();
        steps_.push_back({Step::Kind::add});
      } else if (take("-")) {
        product();
        steps_.push_back({Step::Kind::subtract});
      } else {
        break;
      }
    }
    --depth_;
  }

  void product() {
    signed_power();
    for (;;) {
      next();
      if (text_.substr(at_).starts_with("**")) unexpected();  // of what no power can be taken
      if (take("*")) {
        signed_power();
        steps_.push_back({Step::Kind::multiply});
      } else if (take("/")) {
        signed_power();
        steps_.push_back({Step::Kind::divide});
      } else {
        return;
      }
    }
  }

  /// -2 ** 2 is -4, 2 ** -1 is 0.5, 2 ** 3 ** 2 is 2 ** 9.
  void signed_power() {
    if (++depth_ > deepest) throw Problem{fmt::format("is a formula of over {} levels", deepest)};
    if (take("-")) {
      signed_power();
      steps_.push_back({Step::Kind::negate});
    } else if (take("+")) {
      signed_power();
    } else {
      operand();
      if (take("**")) {
        signed_power();
        steps_.push_back({Step::Kind::power});
      }
    }
    --depth_;
  }

  void operand() {
    const char c = next();
    if (take("(")) {
      sum();
      need(")");
    } else if ((c >= '0' && c <= '9') || c == '.') {
      number();
    } else {
      name();
    }
  }

  void number() {
    double value = 0.0;
    const char* const from = text_.data() + at_;
    const auto [end, error] = std::from_chars(from, text_.data() + text_.size(), value);
    if (error != std::errc{}) unexpected();
    at_ += static_cast<std::size_t>(end - from);
    steps_.push_back({Step::Kind::number, value});
  }

  void name() {
    const std::size_t from = at_;
    std::string name;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      const bool upper = c >= 'A' && c <= 'Z';
      const bool digit = c >= '0' && c <= '9' && !name.empty();
      if (!upper && !digit && !(c >= 'a' && c <= 'z')) break;
      name += upper ? static_cast<char>(c - 'A' + 'a') : c;
    }
    if (name == "x" || name == "x1") {
      steps_.push_back({Step::Kind::variable});
      return;
    }
    if (name == "log")
      throw Problem{
          fmt::format("is the formula '{}': 'log' is the natural logarithm to some programs and "
                      "that of base 10 "
                      "to others",
                      told())};
    const auto known =
        std::ranges::find(functions, name, &std::pair<std::string_view, double (*)(double)>::first);
    if (name != "pow" && known == functions.end()) {
      at_ = from;
      unexpected();
    }
    need("(");
    sum();
    if (name == "pow") {
      need(",");
      sum();
    }
    need(")");
    if (name == "pow")
      steps_.push_back({Step::Kind::power});
    else
      steps_.push_back({Step::Kind::function, 0.0, known->second});
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::vector<Step> steps_;
};

}  // namespace

Formula read_formula(std::string_view text) {
  try {
    auto steps = std::make_shared<const std::vector<Step>>(Reader(text).steps());
    return {[steps](double x) { return calculated(*steps, x); }, {}};
  } catch (const Problem& problem) {
    return {{}, problem.what};
  }
}

}  // namespace impactrig::acquisition
