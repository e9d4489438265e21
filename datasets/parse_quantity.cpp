// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "datasets/units.hpp"

namespace impactrig::datasets {

namespace {

struct Dimension {
  std::string_view unit;
  std::string_view name;  ///< with its article
};

/// What a person calls the dimension of a unit. The first that converts is taken.
constexpr std::array<Dimension, 22> dimensions{{
    {"m", "a length"},                   //
    {"m^2", "an area"},                  //
    {"m^4", "a second moment of area"},  //
    {"s", "a time"},                     //
    {"kg", "a mass"},                    //
    {"N", "a force"},                    //
    {"m/s", "a velocity"},               //
    {"m/s^2", "an acceleration"},        //
    {"Pa", "a pressure or modulus"},     //
    {"kg/m^3", "a density"},             //
    {"kg/m", "a mass per length"},       //
    {"N/m", "a stiffness"},              //
    {"N s/m", "a damping constant"},     //
    {"N s", "an impulse"},               //
    {"J", "an energy or torque"},        //
    {"rad", "an angle"},                 //
    {"Hz", "a frequency"},               //
    {"V", "a voltage"},                  //
    {"C", "a charge"},                   //
    {"K", "a temperature"},              //
    {"rad/s", "an angular velocity"},    //
    {"1", "a plain number"},             //
}};

std::string dimension_of(std::string_view unit) {
  const bool angle = quantity_of_unit(unit) == Quantity::angle;
  for (const Dimension& entry : dimensions) {
    if (angle != (entry.unit == "rad") && (angle || entry.unit == "rad")) continue;
    if (conversion(unit, entry.unit)) return std::string(entry.name);
  }
  return fmt::format("a quantity in {}", unit);
}

[[noreturn]] void refuse(std::string_view what, std::string_view number, std::string_view unit) {
  const std::string example =
      unit == "1" ? std::string(number) : fmt::format("{} {}", number, unit);
  throw std::invalid_argument(
      fmt::format("{}; {} is needed here, for example \"{}\"", what, dimension_of(unit), example));
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// With every sign in ASCII ("+-" for plus-minus) and no blanks at the ends.
std::string plain_text(std::string_view text) {
  std::string result(text);
  replace_all(result, "\u2212", "-");
  replace_all(result, "\u00a0", " ");
  replace_all(result, "\u202f", " ");
  replace_all(result, "\u00b1", "+-");
  replace_all(result, "+/-", "+-");
  const std::size_t begin = result.find_first_not_of(" \t");
  if (begin == std::string::npos) return {};
  return result.substr(begin, result.find_last_not_of(" \t") + 1 - begin);
}

/// Reads a quantity from left to right; `text` as plain_text() gives it.
class QuantityReader {
 public:
  QuantityReader(std::string_view text, std::string_view unit)
      : text_(text),
        rest_(text),
        unit_(unit) {}

  UncertainValue read() {
    const bool grouped = take('(');
    UncertainValue result = number();
    blanks();
    if (rest_.starts_with("+-")) {
      if (result.uncertainty != 0.0)
        refuse(fmt::format("\"{}\" has two uncertainties", text_), "1(1)", unit_);
      rest_.remove_prefix(2);
      blanks();
      if (rest_.empty() || !(is_digit(rest_.front()) || rest_.front() == '.'))
        refuse(fmt::format("\"{}\" has no number after the \u00b1", text_), "1 \u00b1 0.1", unit_);
      result.uncertainty = number().value;
      blanks();
    }
    if (grouped && !take(')'))
      refuse(fmt::format("\"{}\" has no closing parenthesis", text_), "(1 \u00b1 0.1)", unit_);
    blanks();
    return result;
  }

  std::string_view rest() const { return rest_; }

  std::string_view number_text() const { return number_; }

 private:
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }

  bool take(char c) {
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  void blanks() {
    while (take(' ') || take('\t')) continue;
  }

  std::string_view digits() {
    const auto end = std::ranges::find_if_not(rest_, is_digit);
    const auto count = static_cast<std::size_t>(end - rest_.begin());
    const std::string_view result = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return result;
  }

  /// "e-3" after the mantissa; the "e" of "5eV" is left to the unit. 0 where there is none.
  int exponent() {
    if (rest_.empty() || (rest_.front() != 'e' && rest_.front() != 'E')) return 0;
    std::string_view after = rest_.substr(1);
    const bool negative = after.starts_with('-');
    if (negative || after.starts_with('+')) after.remove_prefix(1);
    if (after.empty() || !is_digit(after.front())) return 0;
    rest_ = after;
    const std::string_view figures = digits();
    int value = 0;
    // More than an int holds is beyond every double, which decimal() then says.
    if (std::from_chars(figures.data(), figures.data() + figures.size(), value).ec != std::errc{})
      value = 100000;
    value = std::min(value, 100000);
    return negative ? -value : value;
  }

  double decimal(std::string_view figures, int power) const {
    const std::string number = fmt::format("{}e{}", figures, power);
    double value = 0.0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc{})
      refuse(fmt::format("\"{}\" holds a number that does not fit a double", text_), "1", unit_);
    return value;
  }

  struct Spread {
    std::string figures;
    bool has_point = false;
    std::optional<int> power;
  };

  /// "(5)", "(0.05)" or "(5e-2)"; no figures where there is none.
  Spread parenthesis() {
    Spread spread;
    if (!(rest_.size() > 1 && rest_.front() == '(' && is_digit(rest_[1]))) return spread;
    take('(');
    spread.figures = digits();
    spread.has_point = take('.');
    if (spread.has_point) spread.figures += fmt::format(".{}", digits());
    const std::size_t left = rest_.size();
    const int power = exponent();
    if (rest_.size() < left) spread.power = power;
    if (!take(')'))
      refuse(fmt::format("\"{}\" has no closing parenthesis", text_), "1.00(1)", unit_);
    return spread;
  }

  /// Behind an exponent: whether there is one uncertainty at most, and that either within what the
  /// exponent scales or with an exponent of its own.
  bool unambiguous(Spread& spread) {
    const Spread behind = parenthesis();
    if (behind.figures.empty()) return !spread.power;
    if (!spread.figures.empty() || !behind.power) return false;
    spread = behind;
    return true;
  }

  /// "-12.34(5)e-3" with the uncertainty in the last digits, "12.34(0.05)", or "1.6e10(2e8)" with
  /// one that has an exponent of its own.
  UncertainValue number() {
    const char* const begin = rest_.data();
    const bool negative = take('-');
    if (!negative) take('+');
    std::string figures(digits());
    int decimals = 0;
    if (take('.')) {
      const std::string_view fraction = digits();
      if (!figures.empty() || !fraction.empty()) figures += fmt::format(".{}", fraction);
      decimals = static_cast<int>(fraction.size());
    }
    if (figures.empty() || figures == ".")
      refuse(fmt::format("\"{}\" does not begin with a number", text_), "1", unit_);
    if (figures.front() == '.') figures.insert(0, "0");
    if (rest_.size() > 1 && rest_.front() == ',' && is_digit(rest_[1]))
      refuse(fmt::format("\"{}\" has a comma in its number", text_), "1.5", unit_);

    Spread spread = parenthesis();
    const std::size_t left = rest_.size();
    const int power = exponent();
    if (rest_.size() < left && !unambiguous(spread))
      refuse(fmt::format("\"{}\" leaves open how large its uncertainty is", text_), "1.6(2)e3",
             unit_);
    if (number_.empty()) number_ = {begin, static_cast<std::size_t>(rest_.data() - begin)};
    const double magnitude = decimal(figures, power);
    UncertainValue result{negative ? -magnitude : magnitude, 0.0};
    if (spread.power)
      result.uncertainty = decimal(spread.figures, *spread.power);
    else if (!spread.figures.empty())
      result.uncertainty = decimal(spread.figures, power - (spread.has_point ? 0 : decimals));
    return result;
  }

  std::string_view text_;
  std::string_view rest_;
  std::string_view unit_;
  std::string_view number_;
};

}  // namespace

UncertainValue parse_quantity(std::string_view text, std::string_view unit) {
  if (quantity_of_unit(unit) == Quantity::unknown)
    throw std::invalid_argument(fmt::format("\"{}\" is not a unit to convert to", unit));
  const std::string plain = plain_text(text);
  if (plain.empty()) refuse("nothing is given", "1", unit);
  QuantityReader reader(plain, unit);
  UncertainValue result = reader.read();
  const std::string_view number = reader.number_text();
  const std::string_view given = reader.rest();
  if (given.find("+-") != std::string_view::npos)
    refuse(fmt::format("\"{}\" has its uncertainty behind the unit", plain),
           fmt::format("{} \u00b1 0.1", number), unit);
  if (given.empty() && unit != "1") refuse(fmt::format("{} has no unit", number), number, unit);
  if (given.empty()) return result;

  const bool starts_with_number =
      given != "1" && !given.starts_with("1/") &&
      given.find_first_not_of("(+-.,") == given.find_first_of("0123456789");
  if (starts_with_number || quantity_of_unit(given) == Quantity::unknown)
    refuse(fmt::format("\"{}\" is not a unit", given), number, unit);
  const std::optional<UnitConversion> to_unit = conversion(given, unit);
  if (!to_unit) refuse(fmt::format("\"{}\" is {}", plain, dimension_of(given)), number, unit);
  result.value = to_unit->factor * result.value + to_unit->offset;
  result.uncertainty *= std::abs(to_unit->factor);
  if (!std::isfinite(result.value) || !std::isfinite(result.uncertainty))
    refuse(fmt::format("\"{}\" does not fit a double in {}", plain, unit), "1", unit);
  return result;
}

}  // namespace impactrig::datasets
