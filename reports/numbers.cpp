// SPDX-License-Identifier: BSD-3-Clause
#include "reports/numbers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace impactrig::reports {

namespace {

struct Prefix {
  double power;
  const char* text;
};

constexpr std::array<Prefix, 7> prefixes{
    {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1.0, ""}, {1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}}};

/// Whether a prefix before the unit multiplies the unit as a whole, and reads well.
bool takes_prefix(std::string_view unit) {
  const std::size_t end = unit.find_first_of("/ *·");
  const std::string_view first = unit.substr(0, end);
  constexpr std::array<std::string_view, 9> symbols{
      {"s", "N", "m", "J", "Hz", "Pa", "V", "C", "rad"}};
  return std::ranges::find(symbols, first) != symbols.end();
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// The true minus sign; a rounded zero has none.
std::string signed_text(std::string digits) {
  if (digits.empty() || digits[0] != '-') return digits;
  if (digits.find_first_of("123456789") == std::string::npos) return digits.substr(1);
  return "−" + digits.substr(1);
}

std::string superscript(int exponent) {
  constexpr std::array<const char*, 10> digits{{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"}};
  std::string out = exponent < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(exponent)))
    out += digits[static_cast<std::size_t>(c - '0')];
  return out;
}

/// The power of ten of the second significant digit of `error`, after rounding: 0.0996 -> -2.
int last_place(double error) {
  int place = static_cast<int>(std::floor(std::log10(error))) - 1;
  if (std::round(error / std::pow(10.0, place)) >= 100.0) ++place;
  return place;
}

/// Rounded to 10^place, without digits behind it.
std::string at_place(double value, int place) {
  if (place <= 0) return signed_text(fmt::format("{:.{}f}", value, -place));
  const double unit = std::pow(10.0, place);
  return signed_text(fmt::format("{:.0f}", std::round(value / unit) * unit));
}

bool usable(double error) {
  return std::isfinite(error) && error > 0.0;
}

}  // namespace

std::string pretty_unit(std::string_view unit) {
  if (unit == "1") return "";
  std::string out(unit);
  replace_all(out, "^-1", "⁻¹");
  replace_all(out, "^-2", "⁻²");
  replace_all(out, "^2", "²");
  replace_all(out, "^3", "³");
  replace_all(out, "^4", "⁴");
  replace_all(out, " ", "·");
  return out;
}

DisplayUnit display_unit(double magnitude, std::string_view unit) {
  const std::string pretty = pretty_unit(unit);
  if (!std::isfinite(magnitude) || magnitude <= 0.0 || !takes_prefix(unit)) return {1.0, pretty};
  for (const Prefix& prefix : prefixes)
    // 1571 N reads better than 1.571 kN.
    if (magnitude >= (prefix.power == 1e3 ? 2.0 : 1.0) * prefix.power)
      return {1.0 / prefix.power, prefix.text + pretty};
  return {1e9, "n" + pretty};
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  const double mantissa = value / std::pow(10.0, exponent);
  if (std::abs(std::round(mantissa * std::pow(10.0, digits - 1))) >= std::pow(10.0, digits))
    ++exponent;
  if (exponent < -4 || exponent >= 6)
    return at_place(value / std::pow(10.0, exponent), 1 - digits) + "·10" + superscript(exponent);
  return at_place(value, exponent - digits + 1);
}

std::string quantity(double value, std::string_view unit, int digits) {
  if (!std::isfinite(value)) return "–";
  const DisplayUnit shown = display_unit(std::abs(value), unit);
  const std::string number = significant(value * shown.factor, digits);
  return shown.text.empty() ? number : number + "\u00a0" + shown.text;
}

RoundedValue rounded(double value, double error, std::string_view unit) {
  if (!std::isfinite(value)) return {"–", "", pretty_unit(unit)};
  if (!usable(error)) {
    const DisplayUnit shown = display_unit(std::abs(value), unit);
    return {significant(value * shown.factor, 4), "", shown.text};
  }
  const DisplayUnit shown = display_unit(std::max(std::abs(value), error), unit);
  const int place = last_place(error * shown.factor);
  if (place < -9 || place > 6)
    return {significant(value * shown.factor, 4), significant(error * shown.factor, 2), shown.text};
  return {at_place(value * shown.factor, place), at_place(error * shown.factor, place), shown.text};
}

std::string to_precision_of(double value, double error, const DisplayUnit& unit) {
  if (!std::isfinite(value)) return "–";
  if (!usable(error)) return significant(value * unit.factor, 4);
  const int place = last_place(error * unit.factor);
  if (place < -9 || place > 6) return significant(value * unit.factor, 4);
  return at_place(value * unit.factor, place);
}

NumberColumn number_column(const std::vector<double>& values, std::string_view unit, int digits,
                           double at_least) {
  double largest = at_least;
  for (const double value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  NumberColumn column;
  column.unit = display_unit(largest, unit);
  largest *= column.unit.factor;
  const int place =
      largest > 0.0 ? static_cast<int>(std::floor(std::log10(largest))) - digits + 1 : 0;
  for (const double value : values) {
    const double shown = value * column.unit.factor;
    if (!std::isfinite(value))
      column.cells.push_back("–");
    else
      column.cells.push_back(place < -6 || place > 6 ? significant(shown, digits)
                                                     : at_place(shown, std::min(place, 0)));
  }
  return column;
}

std::string percent(double fraction) {
  if (!std::isfinite(fraction)) return "–";
  const double value = 100.0 * fraction;
  const double size = std::abs(value);
  if (size >= 9.95) return signed_text(fmt::format("{:.0f}", value)) + "\u00a0%";
  if (size >= 0.095) return signed_text(fmt::format("{:.1f}", value)) + "\u00a0%";
  return significant(value, 1) + "\u00a0%";
}

std::string grouped(unsigned long long count) {
  std::string digits = std::to_string(count);
  if (digits.size() < 5) return digits;
  for (std::size_t at = digits.size() - 3; at > 0 && at < digits.size();
       at -= std::min<std::size_t>(at, 3))
    digits.insert(at, "\u202f");
  return digits;
}

Ticks nice_ticks(double low, double high, int wanted) {
  Ticks ticks;
  if (!(high > low) || !std::isfinite(low) || !std::isfinite(high)) {
    ticks.values = {std::isfinite(low) ? low : 0.0};
    return ticks;
  }
  const double rough = (high - low) / std::max(1, wanted);
  int exponent = static_cast<int>(std::floor(std::log10(rough)));
  const double fraction = rough / std::pow(10.0, exponent);
  // The geometric means of 1, 2, 5, 10: the step nearest to the wanted one.
  int lead = fraction < 1.4142 ? 1 : fraction < 3.1623 ? 2 : fraction < 7.0711 ? 5 : 10;
  if (lead == 10) {
    lead = 1;
    ++exponent;
  }
  ticks.step = lead * std::pow(10.0, exponent);
  ticks.decimals = std::max(0, -exponent);
  const double slack = 1e-9 * (high - low);
  for (double k = std::ceil((low - slack) / ticks.step); k * ticks.step <= high + slack; k += 1.0)
    ticks.values.push_back(k * ticks.step);
  return ticks;
}

std::string tick_text(double value, int decimals) {
  return signed_text(fmt::format("{:.{}f}", value, decimals));
}

std::vector<std::size_t> min_max_indices(const std::vector<double>& values, std::size_t buckets) {
  const std::size_t n = values.size();
  std::vector<std::size_t> out;
  if (buckets == 0 || n <= 4 * buckets) {
    out.resize(n);
    for (std::size_t i = 0; i < n; ++i) out[i] = i;
    return out;
  }
  const auto less = [](double a, double b) {
    return std::isnan(b) ? false : std::isnan(a) || a < b;
  };
  out.push_back(0);
  for (std::size_t b = 0; b < buckets; ++b) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(b * n / buckets);
    const auto last = values.begin() + static_cast<std::ptrdiff_t>((b + 1) * n / buckets);
    const auto low = std::min_element(first, last, [](double a, double c) {
      return std::isnan(a) ? false : std::isnan(c) || a < c;
    });
    const auto high = std::max_element(first, last, less);
    const auto [early, late] = std::minmax({low - values.begin(), high - values.begin()});
    for (const std::ptrdiff_t at : {early, late})
      if (static_cast<std::size_t>(at) > out.back()) out.push_back(static_cast<std::size_t>(at));
  }
  if (out.back() != n - 1) out.push_back(n - 1);
  return out;
}

}  // namespace impactrig::reports
