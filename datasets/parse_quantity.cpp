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

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// "69e9 Pa" of "69×10^9 Pa", "69 · 10⁹ Pa" and "69*10^9 Pa", whose signs are in ASCII but for the
/// superscripts.
std::string with_exponents(std::string text) {
  constexpr auto superscripts =
      std::to_array<std::string_view>({"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074", "\u2075",
                                       "\u2076", "\u2077", "\u2078", "\u2079"});
  const std::size_t sign = text.find('*');
  if (sign == std::string::npos) return text;
  std::size_t begin = sign, at = sign + 1;
  while (begin > 0 && text[begin - 1] == ' ') --begin;
  while (at < text.size() && text[at] == ' ') ++at;
  const bool behind_number =
      begin > 0 && (is_digit(text[begin - 1]) || text[begin - 1] == ')' || text[begin - 1] == '.');
  if (!behind_number || text.compare(at, 2, "10") != 0) return text;
  at += 2;
  std::string power;
  if (text.compare(at, 1, "^") == 0) {
    ++at;
    if (at < text.size() && (text[at] == '-' || text[at] == '+')) power += text[at++];
    while (at < text.size() && is_digit(text[at])) power += text[at++];
  } else {
    constexpr std::string_view minus = "\u207b";
    if (text.compare(at, minus.size(), minus) == 0) {
      power += '-';
      at += minus.size();
    }
    for (bool found = true; found;) {
      found = false;
      for (std::size_t digit = 0; digit < superscripts.size() && !found; ++digit) {
        found = text.compare(at, superscripts[digit].size(), superscripts[digit]) == 0;
        if (found) power += static_cast<char>('0' + digit);
        if (found) at += superscripts[digit].size();
      }
    }
  }
  if (power.empty() || !is_digit(power.back())) return text;
  return text.replace(begin, at - begin, "e" + power);
}

/// With every sign in ASCII ("+-" for plus-minus) and no blanks at the ends.
std::string plain_text(std::string_view text) {
  std::string result(text);
  replace_all(result, "\u2212", "-");
  replace_all(result, "\u00a0", " ");
  replace_all(result, "\u202f", " ");
  replace_all(result, "\u00b1", "+-");
  replace_all(result, "+/-", "+-");
  for (const std::string_view sign : {"\u00d7", "\u00b7", "\u22c5"})
    if (const std::size_t at = result.find(sign);
        at != std::string::npos && result.find("10", at) != std::string::npos)
      result.replace(at, sign.size(), "*");
  result = with_exponents(std::move(result));
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
      // "69 +- 1 % GPa"; "30 +- 2 %" is a number whose unit is the percent
      if (rest_.starts_with('%') && rest_.find_first_not_of(" \t)", 1) != rest_.npos) {
        rest_.remove_prefix(1);
        result.uncertainty *= 0.01 * std::abs(result.value);
        blanks();
      }
    }
    if (grouped && !take(')'))
      refuse(fmt::format("\"{}\" has no closing parenthesis", text_), "(1 \u00b1 0.1)", unit_);
    blanks();
    return result;
  }

  std::string_view rest() const { return rest_; }

  std::string_view number_text() const { return number_; }

 private:
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

/// 0.02 of "2%", "+- 2 %"; none of anything else.
std::optional<double> percent_in(std::string_view text) {
  const auto trim = [&text] {
    while (text.starts_with(' ')) text.remove_prefix(1);
    while (text.ends_with(' ')) text.remove_suffix(1);
  };
  trim();
  if (text.starts_with("+-")) text.remove_prefix(2);
  if (!text.ends_with('%')) return std::nullopt;
  text.remove_suffix(1);
  trim();
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= 0.0))
    return std::nullopt;
  return 0.01 * value;
}

/// Takes an uncertainty in percent off the end of a unit: "GPa +- 2 %", "GPa (2%)".
std::optional<double> take_percent(std::string_view& unit) {
  const std::size_t sign = unit.find("+-"), open = unit.rfind('(');
  std::optional<double> percent;
  std::size_t end = unit.npos;
  if (unit.ends_with(')') && open != unit.npos && open > 0) {
    percent = percent_in(unit.substr(open + 1, unit.size() - open - 2));
    end = open;
  } else if (sign != unit.npos && sign > 0) {
    percent = percent_in(unit.substr(sign));
    end = sign;
  }
  if (!percent) return std::nullopt;
  unit = unit.substr(0, end);
  while (unit.ends_with(' ')) unit.remove_suffix(1);
  return percent;
}

/// "mV/N (5)": what the number says is open.
bool ends_with_a_number_in_parentheses(std::string_view unit) {
  const std::size_t open = unit.rfind('(');
  return unit.ends_with(')') && open != unit.npos && open > 0 &&
         std::string_view("/^.*").find(unit[open - 1]) == std::string_view::npos &&
         (is_digit(unit[open + 1]) || unit[open + 1] == '+');
}

}  // namespace

UncertainValue parse_quantity(std::string_view text, std::string_view unit) {
  if (quantity_of_unit(unit) == Quantity::unknown)
    throw std::invalid_argument(fmt::format("\"{}\" is not a unit to convert to", unit));
  const std::string plain = plain_text(text);
  if (plain.empty()) refuse("nothing is given", "1", unit);
  QuantityReader reader(plain, unit);
  UncertainValue result = reader.read();
  const std::string_view number = reader.number_text();
  std::string_view given = reader.rest();
  if (const auto percent = take_percent(given)) {
    if (result.uncertainty != 0.0)
      refuse(fmt::format("\"{}\" has two uncertainties", plain), "1(1)", unit);
    result.uncertainty = *percent * std::abs(result.value);
  }
  if (given.find("+-") != std::string_view::npos)
    refuse(fmt::format("\"{}\" has its uncertainty behind the unit", plain),
           fmt::format("{} \u00b1 0.1", number), unit);
  if (given.empty() && unit != "1") refuse(fmt::format("{} has no unit", number), number, unit);
  if (given.empty()) return result;

  const bool starts_with_number =
      given != "1" && !given.starts_with("1/") &&
      given.find_first_not_of("(+-.,") == given.find_first_of("0123456789");
  if (starts_with_number || ends_with_a_number_in_parentheses(given) ||
      quantity_of_unit(given) == Quantity::unknown)
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
