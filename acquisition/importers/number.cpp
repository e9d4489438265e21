// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/number.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

namespace impactrig::acquisition {

namespace detail {

bool convert_number(std::string_view text, NumberStyle style, double& value) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto direct = std::from_chars(text.data(), text.data() + text.size(), value);
  if (direct.ec == std::errc{} && direct.ptr == text.data() + text.size()) return true;

  std::string plain;
  plain.reserve(text.size() + 1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == style.decimal) {
      plain += '.';
    } else if (c == 'd' || c == 'D') {
      plain += 'e';
    } else {
      const bool bare_exponent = (c == '+' || c == '-') && i > 0 && text[i - 1] != 'e' &&
                                 text[i - 1] != 'E' && text[i - 1] != 'd' && text[i - 1] != 'D';
      if (bare_exponent) plain += 'e';
      plain += c;
    }
  }
  const char* const end = plain.data() + plain.size();
  const auto result = std::from_chars(plain.data(), end, value);
  if (result.ptr != end) return false;
  if (result.ec == std::errc{}) return true;
  value = std::strtod(plain.c_str(), nullptr);  // out of range: below the least double is still 0
  return std::abs(value) < 1.0;
}

}  // namespace detail

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks(" \t\r\n\0", 5);
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::optional<double> number_in(std::string_view text, NumberStyle style) {
  const std::string_view cell = trimmed(text);
  double value = 0.0;
  const char* const end = scan_number(cell.data(), cell.data() + cell.size(), style, value);
  if (cell.empty() || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

namespace {

/// mantissa * 10^power.
struct Decimal {
  std::int64_t mantissa = 0;
  int power = 0;

  /// False where the mantissa becomes too large.
  bool shift_to(int lower_power) {
    for (; power > lower_power; --power)
      if (__builtin_mul_overflow(mantissa, std::int64_t{10}, &mantissa)) return false;
    return true;
  }
};

std::optional<Decimal> decimal_in(std::string_view text, NumberStyle style) {
  const char* p = text.data();
  const char* const last = p + text.size();
  const bool negative = p != last && *p == '-';
  if (p != last && (*p == '-' || *p == '+')) ++p;
  Decimal decimal;
  bool any = false, behind_mark = false;
  for (; p != last && (detail::is_digit(*p) || (*p == style.decimal && !behind_mark)); ++p) {
    if (*p == style.decimal) {
      behind_mark = true;
      continue;
    }
    any = true;
    if (__builtin_mul_overflow(decimal.mantissa, std::int64_t{10}, &decimal.mantissa) ||
        __builtin_add_overflow(decimal.mantissa, std::int64_t{*p - '0'}, &decimal.mantissa))
      return std::nullopt;
    if (behind_mark) --decimal.power;
  }
  int exponent = 0;
  p = detail::scan_exponent(p, last, style.fortran, exponent);
  if (!any || p != last) return std::nullopt;
  decimal.power += exponent;
  if (negative) decimal.mantissa = -decimal.mantissa;
  return decimal;
}

}  // namespace

std::optional<double> decimal_difference(std::string_view text, std::string_view from,
                                         NumberStyle style) {
  auto a = decimal_in(trimmed(text), style);
  auto b = decimal_in(trimmed(from), style);
  if (!a || !b) return std::nullopt;
  const int power = std::min(a->power, b->power);
  if (power < -22 || power > 22 || !a->shift_to(power) || !b->shift_to(power)) return std::nullopt;
  std::int64_t exact = 0;
  if (__builtin_sub_overflow(a->mantissa, b->mantissa, &exact)) return std::nullopt;
  const auto difference = static_cast<double>(exact);
  return power < 0 ? difference / detail::powers_of_ten[-power]
                   : difference * detail::powers_of_ten[power];
}

std::optional<long> integer_in(std::string_view text) {
  std::string_view cell = trimmed(text);
  if (cell.size() > 1 && cell.front() == '+' && detail::is_digit(cell[1])) cell.remove_prefix(1);
  long value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (cell.empty() || error != std::errc{} || end != cell.data() + cell.size()) return std::nullopt;
  return value;
}

}  // namespace impactrig::acquisition
